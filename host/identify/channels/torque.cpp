// The effort of a joint's drive.
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const Channel channel = find_subject(where, recorded);
  return measured_in(where, recorded, channel, turns(where, channel) ? Unit::torque : Unit::force);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  return sensed(look, look.state.joint_effort[std::size_t(channel.joint)]);
}

}  // namespace

constinit const SensorKind torque_sensor = {.kind = ChannelKind::torque,
                                            .resolve = resolve,
                                            .predict = predict,
                                            .interpolate = cubic_value,
                                            .difference = plain_difference,
                                            .takes_bias = true};

}  // namespace pvg::diagnose
