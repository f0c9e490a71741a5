// A joint's rate: the slope of its simulated coordinate.
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const Channel channel = find_subject(where, recorded);
  return measured_in(where, recorded, channel, turns(where, channel) ? Unit::angular_speed : Unit::speed);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  return sensed(look, look.state.joint_position[std::size_t(channel.joint)]);
}

}  // namespace

constinit const SensorKind rate_sensor = {.kind = ChannelKind::rate,
                                          .resolve = resolve,
                                          .predict = predict,
                                          .interpolate = cubic_slope,
                                          .difference = plain_difference,
                                          .start = StartRole::rate,
                                          .takes_bias = true};

}  // namespace pvg::diagnose
