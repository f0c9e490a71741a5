#include "host/capture/exposure.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {
namespace {

constexpr int ROUNDS = 30;  // of alternating medians; they change by less than 1 % afterwards

float median(std::vector<float>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// samples sorted into lists
template <class Index>
std::vector<std::vector<std::uint32_t>> lists_by(std::span<const ColorSample> samples, std::size_t n,
                                                 const Index& index) {
  std::vector<std::vector<std::uint32_t>> lists(n);
  for (std::size_t i = 0; i < samples.size(); ++i) lists[index(samples[i])].push_back(std::uint32_t(i));
  return lists;
}

}  // namespace

std::vector<Vec3f> exposure_gains(std::span<const ColorSample> samples, std::size_t n_points, std::size_t n_photos) {
  const auto of_point = lists_by(samples, n_points, [](const ColorSample& s) { return s.point; });
  const auto of_photo = lists_by(samples, n_photos, [](const ColorSample& s) { return s.photo; });
  std::vector<Vec3f> gains(n_photos, Vec3f::Ones());
  std::vector<float> values;
  for (int channel = 0; channel < 3; ++channel) {
    std::vector<float> log_gain(n_photos, 0.0f), log_color(n_points, NAN);
    for (int round = 0; round < ROUNDS; ++round) {
      for (std::size_t p = 0; p < n_points; ++p) {
        if (of_point[p].size() < 2) continue;
        values.clear();
        for (const std::uint32_t i : of_point[p])
          values.push_back(std::log(samples[i].color[channel]) + log_gain[samples[i].photo]);
        log_color[p] = median(values);
      }
      double sum = 0;
      std::vector<std::size_t> known;
      for (std::size_t f = 0; f < n_photos; ++f) {
        values.clear();
        for (const std::uint32_t i : of_photo[f])
          if (std::isfinite(log_color[samples[i].point]))
            values.push_back(log_color[samples[i].point] - std::log(samples[i].color[channel]));
        if (values.empty()) continue;
        log_gain[f] = median(values);
        sum += double(log_gain[f]);
        known.push_back(f);
      }
      for (const std::size_t f : known) log_gain[f] -= float(sum / double(known.size()));
    }
    for (std::size_t f = 0; f < n_photos; ++f) gains[f][channel] = std::exp(log_gain[f]);
  }
  return gains;
}

}  // namespace pvg
