// The current of a joint's motor: the effort of its drive over a constant.
#include <stdexcept>

#include "host/base/error.hpp"
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

double constant_of(const ChannelPlace& where, const RecordedChannel& recorded, Unit effort) {
  const std::string per_ampere = "/A", &text = recorded.constant;
  const bool is_whole = text.ends_with(per_ampere);
  double constant = 0;
  try {
    constant = parse_quantity(text.substr(0, text.size() - (is_whole ? per_ampere.size() : 0)), effort);
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(where.entry + ": `constant` " + wrong.what());
  }
  if (!is_whole || constant == 0)
    throw UsageError(where.entry + ": `constant` must be an effort per current, not 0, such as 0.05 " +
                     si_unit(effort) + "/A");
  return constant;
}

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  Channel channel = find_subject(where, recorded);
  channel.constant = constant_of(where, recorded, turns(where, channel) ? Unit::torque : Unit::force);
  RecordedChannel in_ampere = recorded;
  in_ampere.unit.clear();
  if (!recorded.unit.empty() && recorded.unit != "A" && recorded.unit != "mA")
    throw UsageError(where.entry + ": `unit` of a current must be A or mA");
  Resolved resolved = measured_in(where, in_ampere, channel, Unit::none);
  if (recorded.unit == "mA") {
    resolved.to_si = 1e-3;
    resolved.channel.sigma *= 1e-3;
    Readout& readout = resolved.channel.readout;
    readout = {readout.low_pass, 1e-3 * readout.resolution, 1e-3 * readout.lowest, 1e-3 * readout.highest};
  }
  resolved.channel.unit = "A";
  return resolved;
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  return sensed(look, look.state.joint_effort[std::size_t(channel.joint)] / channel.constant);
}

}  // namespace

constinit const SensorKind current_sensor = {.kind = ChannelKind::current,
                                             .resolve = resolve,
                                             .predict = predict,
                                             .interpolate = cubic_value,
                                             .difference = plain_difference,
                                             .takes_bias = true};

}  // namespace pvg::diagnose
