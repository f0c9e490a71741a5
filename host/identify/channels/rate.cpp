// A joint's rate, or the velocity of a rigid body's origin: the slope of its simulated place.
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const Channel channel = find_subject(where, recorded);
  require_rigid(where, recorded, channel);
  Resolved resolved = measured_in(where, recorded, channel, turns(where, channel) ? Unit::angular_speed : Unit::speed);
  resolved.channel.trace_width = 2 * resolved.channel.width;
  return resolved;
}

// the place, and the bias of its rate
std::vector<double> predict(const Channel& channel, const Look& look) {
  const Vec3 bias = entry_of(look.sensing.bias, look.number);
  if (channel.joint >= 0) return {look.state.joint_position[std::size_t(channel.joint)], bias[0]};
  const Vec3 place = in_frame(look, point_of(channel, look));
  if (channel.has_axis) return {channel.axis.dot(place), bias[0]};
  return {place[0], place[1], place[2], bias[0], bias[1], bias[2]};
}

}  // namespace

constinit const SensorKind rate_sensor = {.kind = ChannelKind::rate,
                                          .resolve = resolve,
                                          .predict = predict,
                                          .interpolate = slope_with_bias,
                                          .difference = plain_difference,
                                          .start = StartRole::rate,
                                          .is_length = true,
                                          .takes_bias = true};

}  // namespace pvg::diagnose
