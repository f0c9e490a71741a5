// A joint's coordinate, or the origin of a rigid body in the measurement's frame.
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const Channel channel = find_subject(where, recorded);
  require_rigid(where, recorded, channel);
  return measured_in(where, recorded, channel, turns(where, channel) ? Unit::angle : Unit::length);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  if (channel.joint >= 0) return sensed(look, look.state.joint_position[std::size_t(channel.joint)]);
  return sensed_length(channel, look, point_of(channel, look));
}

}  // namespace

constinit const SensorKind position_sensor = {.kind = ChannelKind::position,
                                              .resolve = resolve,
                                              .predict = predict,
                                              .interpolate = cubic_value,
                                              .difference = plain_difference,
                                              .start = StartRole::place,
                                              .is_length = true,
                                              .takes_bias = true};

}  // namespace pvg::diagnose
