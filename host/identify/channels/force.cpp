// The sum of the contact forces on a body, world frame, or the force of a joint's child on its parent, along the axes
// of the joint frame on the child.
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"
#include "host/physics/energies/joint_anchors.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const Channel channel = is_joint_load(recorded) ? find_joint_load(where, recorded) : find_subject(where, recorded);
  return measured_in(where, recorded, channel, Unit::force);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  const WorldState& state = look.state;
  if (channel.joint >= 0) {
    const Joint& joint = look.world.joints[std::size_t(channel.joint)];
    return sensed(
        channel, look,
        joint_load(joint, state.rigid[std::size_t(joint.parent)], state.rigid[std::size_t(joint.child)]).force);
  }
  const std::size_t body = channel.rigid >= 0  ? std::size_t(channel.rigid)
                           : channel.soft >= 0 ? state.rigid.size() + std::size_t(channel.soft)
                                               : state.rigid.size() + state.soft.size() + std::size_t(channel.cloth);
  return sensed(channel, look, body < state.body_force.size() ? state.body_force[body].force : Vec3(Vec3::Zero()));
}

}  // namespace

constinit const SensorKind force_sensor = {.kind = ChannelKind::force,
                                           .resolve = resolve,
                                           .predict = predict,
                                           .interpolate = cubic_value,
                                           .difference = plain_difference,
                                           .takes_bias = true,
                                           .is_known_after_a_step = true};

}  // namespace pvg::diagnose
