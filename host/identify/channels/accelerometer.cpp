// What an accelerometer on a rigid body says, along the body's axes: R^T (a - g), 9.81 m/s^2 upwards at rest. a is the
// second difference of its place over three steps.
#include "host/identify/channels/inertial.hpp"
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

// what is kept of a step
constexpr std::size_t PLACE = 0, ROTATION = 3, GRAVITY = 12, BIAS = 15;

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  Channel channel = find_subject(where, recorded);
  require_rigid(where, recorded, channel);
  if (recorded.point) channel.point = *recorded.point;
  Resolved resolved = measured_in(where, recorded, channel, Unit::acceleration);
  resolved.channel.trace_width = BIAS + 3;
  return resolved;
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  std::vector<double> trace;
  put(trace, point_of(channel, look));
  put(trace, Mat3(look.state.rigid[std::size_t(channel.rigid)].leftCols<3>()));
  put(trace, look.world.gravity);
  put(trace, entry_of(look.sensing.bias, look.number));
  return trace;
}

std::vector<double> interpolate(const Channel& channel, const Steps& steps, double time) {
  const auto felt = [&](std::size_t before) -> Vec3 {  // in the middle of three steps
    const std::size_t step = before + 1;
    const Vec3 twice = vector_at(steps, before, PLACE) + vector_at(steps, step + 1, PLACE);
    const Vec3 acceleration = (twice - 2 * vector_at(steps, step, PLACE)) / (steps.h * steps.h);
    return rotation_at(steps, step, ROTATION).transpose() * (acceleration - vector_at(steps, step, GRAVITY));
  };
  const auto [step, share] = between(time / steps.h, 1, steps.n() - 2);
  const Vec3 value = (1 - share) * felt(step) + share * felt(step + 1) + vector_at(steps, 0, BIAS);
  return along(channel, value);
}

}  // namespace

constinit const SensorKind accelerometer_sensor = {.kind = ChannelKind::accelerometer,
                                                   .resolve = resolve,
                                                   .predict = predict,
                                                   .interpolate = interpolate,
                                                   .difference = plain_difference,
                                                   .has_mounting_place = true,
                                                   .takes_bias = true};

}  // namespace pvg::diagnose
