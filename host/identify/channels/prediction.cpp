#include "host/identify/channels/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

// Sum over the four steps around `time` of their values, each times share(weight, slope, time before the start) of its
// cubic Lagrange polynomial.
template <class Share>
std::vector<double> cubic(const Steps& steps, double time, const Share& share_of) {
  const std::size_t n = steps.n(), width = steps.width;
  const double place = std::max(time / steps.h, 0.0), before_start = std::min(time, 0.0);
  const std::size_t first = std::size_t(std::clamp<double>(std::floor(place) - 1, 0, double(n - 4)));
  const double s = place - double(first);
  std::vector<double> value(width, 0);
  const double* reference = &steps.values[width * first];
  for (std::size_t i = 0; i < 4; ++i) {
    double weight = 1, slope = 0;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) weight *= (s - double(j)) / (double(i) - double(j));
    for (std::size_t m = 0; m < 4; ++m) {
      if (m == i) continue;
      double product = 1 / (double(i) - double(m));
      for (std::size_t j = 0; j < 4; ++j)
        if (j != i && j != m) product *= (s - double(j)) / (double(i) - double(j));
      slope += product;
    }
    const double* at = &steps.values[width * (first + i)];
    double sign = 1;  // q and -q are the same rotation
    if (width == 4)
      sign = Eigen::Map<const Eigen::Vector4d>(at).dot(Eigen::Map<const Eigen::Vector4d>(reference)) < 0 ? -1 : 1;
    const double share = share_of(weight, slope, before_start);
    for (std::size_t k = 0; k < width; ++k) value[k] += sign * at[k] * share;
  }
  return value;
}

}  // namespace

Mat3 rotation_of(const Vec3& vector) {
  const double angle = vector.norm();
  return angle > 0 ? Mat3(Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix()) : Mat3(Mat3::Identity());
}

Vec3 entry_of(const std::vector<Vec3>& list, std::size_t channel) {
  return list.empty() ? Vec3(Vec3::Zero()) : list[channel];
}

std::vector<double> sensed(const Look& look, double value) {
  return {value + entry_of(look.sensing.bias, look.number)[0]};
}

std::vector<double> sensed(const Channel& channel, const Look& look, const Vec3& value) {
  const Vec3 bias = entry_of(look.sensing.bias, look.number);
  if (channel.has_axis) return {channel.axis.dot(value) + bias[0]};
  return {value[0] + bias[0], value[1] + bias[1], value[2] + bias[2]};
}

Vec3 in_frame(const Look& look, const Vec3& value) {
  return (1 + look.sensing.length_scale) * (rotation_of(look.sensing.frame_rotation) * value);
}

std::vector<double> sensed_length(const Channel& channel, const Look& look, const Vec3& value) {
  return sensed(channel, look, in_frame(look, value));
}

Vec3 point_of(const Channel& channel, const Look& look) {
  const Vec3 offset = entry_of(look.sensing.marker_offset, look.number);
  if (channel.rigid >= 0) {
    const AffineMap& map = look.state.rigid[std::size_t(channel.rigid)];
    return map.leftCols<3>() * (channel.point + offset) + map.col(3);
  }
  const std::vector<Vec3>& points =
      channel.soft >= 0 ? look.state.soft[std::size_t(channel.soft)] : look.state.cloth[std::size_t(channel.cloth)];
  Vec3 x = Vec3::Zero();
  for (const auto& [node, weight] : channel.nodes) x += weight * points[node];
  x += offset;
  return x;
}

std::vector<double> cubic_value(const Channel&, const Steps& steps, double time) {
  return cubic(steps, time, [&](double weight, double slope, double before_start) {
    return weight + before_start * slope / steps.h;
  });
}

std::vector<double> slope_with_bias(const Channel&, const Steps& steps, double time) {
  const std::vector<double> slope = cubic(steps, time, [&](double, double slope, double) { return slope / steps.h; });
  const std::vector<double> value = cubic(steps, time, [&](double weight, double, double) { return weight; });
  std::vector<double> rate;
  for (std::size_t k = 0; k < steps.width / 2; ++k) rate.push_back(slope[k] + value[steps.width / 2 + k]);
  return rate;
}

void low_pass(std::vector<double>& steps, std::size_t width, double h, double cut_off) {
  const double tau = 1 / (2 * std::numbers::pi * cut_off), kept = std::exp(-h / tau);
  for (std::size_t k = 0; k < width && steps.size() >= 2 * width; ++k) {
    double before = steps[k], slope = (steps[width + k] - before) / h;
    double y = before - tau * slope;  // what follows a line follows it late by tau
    steps[k] = y;
    for (std::size_t i = width + k; i < steps.size(); i += width) {
      const double now = steps[i];
      slope = (now - before) / h;
      y = now - tau * slope + (y - before + tau * slope) * kept;
      before = now;
      steps[i] = y;
    }
  }
}

std::vector<double> between_pictures(const Channel&, const Steps& steps, double time) {
  const double place = std::max(time / steps.h, 0.0);
  const std::size_t before = std::min(std::size_t(place + 1e-6), steps.n() - 1),
                    after = std::min(before + 1, steps.n() - 1);
  const double share = std::max(place - double(before), 0.0);
  const double a = steps.values[before], b = steps.values[after];
  return {share > 1e-6 ? (1 - share) * a + share * b : a};
}

Vec3 plain_difference(const double* measured, const double* predicted, int n) {
  Vec3 difference = Vec3::Zero();
  for (int k = 0; k < n; ++k) difference[k] = measured[k] - predicted[k];
  return difference;
}

}  // namespace pvg::diagnose
