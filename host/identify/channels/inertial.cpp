#include "host/identify/channels/inertial.hpp"

#include <algorithm>
#include <cmath>

namespace pvg::diagnose {

void put(std::vector<double>& trace, const Vec3& vector) { trace.insert(trace.end(), vector.begin(), vector.end()); }

void put(std::vector<double>& trace, const Mat3& rotation) {
  for (Eigen::Index row = 0; row < 3; ++row) put(trace, Vec3(rotation.row(row).transpose()));
}

Vec3 vector_at(const Steps& steps, std::size_t step, std::size_t offset) {
  return Eigen::Map<const Vec3>(&steps.values[step * steps.width + offset]);
}

Mat3 rotation_at(const Steps& steps, std::size_t step, std::size_t offset) {
  Mat3 rotation;
  for (Eigen::Index row = 0; row < 3; ++row)
    rotation.row(row) = vector_at(steps, step, offset + 3 * std::size_t(row)).transpose();
  return rotation;
}

Between between(double place, double first, std::size_t n) {
  const double at = std::clamp(place - first, 0.0, double(n - 1));
  const std::size_t before = std::min(std::size_t(at), n - 2);
  return {before, at - double(before)};
}

std::vector<double> along(const Channel& channel, const Vec3& value) {
  if (channel.has_axis) return {channel.axis.dot(value)};
  return {value[0], value[1], value[2]};
}

}  // namespace pvg::diagnose
