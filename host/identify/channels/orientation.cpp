// The orientation of a rigid body as a quaternion x, y, z, w. The residual is the rotation vector from the predicted to
// the measured one [rad].
#include <algorithm>

#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const Channel channel = find_subject(where, recorded);
  require_rigid(where, recorded, channel);
  Resolved resolved = measured_in(where, recorded, channel, Unit::none);
  resolved.channel.unit = "rad";
  resolved.channel.n = 3;
  return resolved;
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  const Eigen::Quaterniond q(Mat3(look.state.rigid[std::size_t(channel.rigid)].leftCols<3>()));
  const Eigen::Quaterniond seen(rotation_of(look.sensing.frame_rotation) * q.normalized().toRotationMatrix());
  return {seen.x(), seen.y(), seen.z(), seen.w()};
}

Vec3 difference(const double* measured, const double* predicted, int) {
  const Eigen::Quaterniond q(measured[3], measured[0], measured[1], measured[2]),
      p(predicted[3], predicted[0], predicted[1], predicted[2]);
  const Eigen::AngleAxisd apart(p.normalized().conjugate() * q.normalized());
  return apart.angle() * apart.axis();
}

}  // namespace

constinit const SensorKind orientation_sensor = {.kind = ChannelKind::orientation,
                                                 .resolve = resolve,
                                                 .predict = predict,
                                                 .interpolate = cubic_value,
                                                 .difference = difference,
                                                 .noise = {.per_number = 2},  // its numbers are half angles
                                                 .start = StartRole::turn,
                                                 .is_shown_as_deviation = true};

}  // namespace pvg::diagnose
