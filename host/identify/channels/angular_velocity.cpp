// The angular velocity of a rigid body: in the measurement's frame, or as a gyroscope on it says it, along its own
// axes. Between two steps it is log(R1 R0^T) / h, in the middle of them.
#include "host/identify/channels/inertial.hpp"
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

constexpr std::size_t BIAS = 9;  // after the rotation

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const Channel channel = find_subject(where, recorded);
  require_rigid(where, recorded, channel);
  Resolved resolved = measured_in(where, recorded, channel, Unit::angular_speed);
  resolved.channel.trace_width = BIAS + 3;
  return resolved;
}

std::vector<double> trace_of(const Mat3& rotation, const Look& look) {
  std::vector<double> trace;
  put(trace, rotation);
  put(trace, entry_of(look.sensing.bias, look.number));
  return trace;
}

Mat3 rotation_in(const Channel& channel, const Look& look) {
  return Eigen::Quaterniond(Mat3(look.state.rigid[std::size_t(channel.rigid)].leftCols<3>())).normalized().matrix();
}

std::vector<double> predict_in_world(const Channel& channel, const Look& look) {
  return trace_of(rotation_of(look.sensing.frame_rotation) * rotation_in(channel, look), look);
}

std::vector<double> predict_in_body(const Channel& channel, const Look& look) {
  return trace_of(rotation_in(channel, look), look);
}

// along the axes of the world, or of the body
template <bool in_world>
std::vector<double> interpolate(const Channel& channel, const Steps& steps, double time) {
  const auto spin = [&](std::size_t step) -> Vec3 {
    const Mat3 before = rotation_at(steps, step, 0), after = rotation_at(steps, step + 1, 0);
    const Eigen::AngleAxisd turn(in_world ? Mat3(after * before.transpose()) : Mat3(before.transpose() * after));
    return turn.angle() * turn.axis() / steps.h;
  };
  const auto [step, share] = between(time / steps.h, 0.5, steps.n() - 1);
  const Vec3 value = (1 - share) * spin(step) + share * spin(step + 1) + vector_at(steps, 0, BIAS);
  return along(channel, value);
}

}  // namespace

constinit const SensorKind angular_velocity_sensor = {.kind = ChannelKind::angular_velocity,
                                                      .resolve = resolve,
                                                      .predict = predict_in_world,
                                                      .interpolate = interpolate<true>,
                                                      .difference = plain_difference,
                                                      .takes_bias = true};

constinit const SensorKind gyroscope_sensor = {.kind = ChannelKind::gyroscope,
                                               .resolve = resolve,
                                               .predict = predict_in_body,
                                               .interpolate = interpolate<false>,
                                               .difference = plain_difference,
                                               .takes_bias = true};

}  // namespace pvg::diagnose
