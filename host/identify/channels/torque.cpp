// The effort of a joint's drive, or the torque of all contacts on a body about its origin, world frame.
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const Channel channel = find_subject(where, recorded);
  require_rigid(where, recorded, channel);
  const bool is_force = channel.joint >= 0 && !turns(where, channel);
  return measured_in(where, recorded, channel, is_force ? Unit::force : Unit::torque);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
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
                                            .takes_bias = true};

}  // namespace pvg::diagnose
