#include "host/dataset/feature_stats.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {

NumberStats stats_of(std::vector<double> values) {
  NumberStats stats;
  if (values.empty()) return stats;
  std::sort(values.begin(), values.end());
  const double n = double(values.size());
  double sum = 0, squares = 0;
  for (const double value : values) sum += value;
  stats.mean = sum / n;
  for (const double value : values) squares += (value - stats.mean) * (value - stats.mean);
  stats.std = std::sqrt(squares / n);
  stats.min = values.front();
  stats.max = values.back();
  for (std::size_t i = 0; i < QUANTILES.size(); ++i) {
    const double at = QUANTILES[i] * (n - 1), below = std::floor(at);
    const std::size_t k = std::size_t(below), next = std::min(k + 1, values.size() - 1);
    stats.quantiles[i] = values[k] + (at - below) * (values[next] - values[k]);
  }
  return stats;
}

void PixelCounts::add(std::span<const std::uint8_t> rgb) {
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3)
    for (std::size_t c = 0; c < 3; ++c) ++counts_[c][rgb[i + c]];
}

void PixelCounts::add(const PixelCounts& other) {
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t value = 0; value < 256; ++value) counts_[c][value] += other.counts_[c][value];
}

std::array<NumberStats, 3> PixelCounts::stats() const {
  std::array<NumberStats, 3> all;
  for (std::size_t c = 0; c < 3; ++c) {
    NumberStats& stats = all[c];
    double n = 0, sum = 0, squares = 0;
    for (std::size_t value = 0; value < 256; ++value) {
      const double count = double(counts_[c][value]), x = double(value) / 255;
      if (count > 0 && n == 0) stats.min = x;
      if (count > 0) stats.max = x;
      n += count;
      sum += count * x;
      squares += count * x * x;
    }
    if (n == 0) continue;
    stats.mean = sum / n;
    stats.std = std::sqrt(std::max(0.0, squares / n - stats.mean * stats.mean));
    for (std::size_t i = 0; i < QUANTILES.size(); ++i) {
      double below = 0;
      std::size_t value = 0;
      while (value < 255 && (below += double(counts_[c][value])) < QUANTILES[i] * n) ++value;
      stats.quantiles[i] = double(value) / 255;
    }
  }
  return all;
}

nlohmann::ordered_json to_json(std::span<const NumberStats> stats, std::size_t count, bool is_picture,
                               std::span<const double> least_std) {
  using Json = nlohmann::ordered_json;
  const auto list = [&](const auto& number) {
    Json values = Json::array();
    for (std::size_t i = 0; i < stats.size(); ++i) {
      const double value = number(stats[i], i);
      values.push_back(is_picture ? Json::array({Json::array({value})}) : Json(value));
    }
    return values;
  };
  Json json = {{"min", list([](const NumberStats& s, std::size_t) { return s.min; })},
               {"max", list([](const NumberStats& s, std::size_t) { return s.max; })},
               {"mean", list([](const NumberStats& s, std::size_t) { return s.mean; })},
               {"std", list([&](const NumberStats& s, std::size_t i) {
                  return std::max(s.std, i < least_std.size() ? least_std[i] : 0);
                })},
               {"count", Json::array({count})}};
  for (std::size_t k = 0; k < QUANTILES.size(); ++k)
    json[QUANTILE_NAMES[k]] = list([k](const NumberStats& s, std::size_t) { return s.quantiles[k]; });
  return json;
}

}  // namespace pvg
