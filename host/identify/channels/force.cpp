// The sum of the contact forces on a body, world frame.
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  return measured_in(where, recorded, find_subject(where, recorded), Unit::force);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  const WorldState& state = look.state;
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
                                           .takes_bias = true};

}  // namespace pvg::diagnose
