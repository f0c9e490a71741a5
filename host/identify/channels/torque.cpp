// The effort of a joint's drive; the torque of a fixed joint's child on its parent about the joint, along the axes of
// the joint frame on the child; or the torque of all contacts on a body about its origin, world frame.
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"
#include "host/physics/energies/joint_anchors.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  if (is_joint_load(recorded)) {
    Channel load = find_joint_load(where, recorded);
    load.is_joint_load = true;
    return measured_in(where, recorded, load, Unit::torque);
  }
  const Channel channel = find_subject(where, recorded);
  require_rigid(where, recorded, channel);
  const bool is_force = channel.joint >= 0 && !turns(where, channel);
  return measured_in(where, recorded, channel, is_force ? Unit::force : Unit::torque);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  if (channel.is_joint_load) {
    const Joint& joint = look.world.joints[std::size_t(channel.joint)];
    const std::vector<AffineMap>& pose = look.state.rigid;
    return sensed(channel, look,
                  joint_load(joint, pose[std::size_t(joint.parent)], pose[std::size_t(joint.child)]).torque);
  }
  if (channel.joint >= 0) return sensed(look, look.state.joint_effort[std::size_t(channel.joint)]);
  const std::size_t body = std::size_t(channel.rigid);
  if (body >= look.state.body_force.size()) return sensed(channel, look, Vec3::Zero());
  const BodyForce& felt = look.state.body_force[body];
  const Vec3 arm = look.state.rigid[body].leftCols<3>() * look.world.rigid_bodies[body].center_of_mass;
  return sensed(channel, look, felt.torque + arm.cross(felt.force));
}

}  // namespace

constinit const SensorKind torque_sensor = {.kind = ChannelKind::torque,
                                            .resolve = resolve,
                                            .predict = predict,
                                            .interpolate = cubic_value,
                                            .difference = plain_difference,
                                            .takes_bias = true,
                                            .is_known_after_a_step = true};

}  // namespace pvg::diagnose
