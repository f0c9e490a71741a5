#include "pipeline/diagnose/noise.hpp"

#include <algorithm>
#include <cmath>

namespace pvg::diagnose {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The smallest step between values that differ, if most steps are whole multiples of it.
double quantum_of(const std::vector<double>& values, std::size_t width) {
  std::vector<double> steps;
  for (std::size_t i = width; i < values.size(); ++i) {
    const double step = std::abs(values[i] - values[i - width]);
    if (std::isfinite(step) && step > 0) steps.push_back(step);
  }
  if (steps.size() < 20) return 0;
  const double least = *std::min_element(steps.begin(), steps.end());
  const auto whole = std::count_if(steps.begin(), steps.end(), [&](double step) {
    return std::abs(step / least - std::round(step / least)) < 0.05 && step / least < 1000;
  });
  return whole > 0.9 * double(steps.size()) ? least : 0;
}

}  // namespace

double noise_of(const std::vector<double>& values, std::size_t width) {
  std::vector<double> differences;
  for (std::size_t i = 3 * width; i < values.size(); ++i) {
    const double d = values[i] - 3 * values[i - width] + 3 * values[i - 2 * width] - values[i - 3 * width];
    if (std::isfinite(d)) differences.push_back(std::abs(d));
  }
  if (differences.size() < 8) return std::nan("");
  const double sigma = 1.4826 * median(std::move(differences)) / std::sqrt(20.0);
  return std::max(sigma, quantum_of(values, width) / std::sqrt(12.0));
}

void measure_noise(Problem& problem) {
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    Channel& channel = problem.channels[c];
    if (channel.is_noise_known) continue;
    std::vector<double> found;
    double range = 0;
    for (const Run& run : problem.runs) {
      // an orientation's numbers are half angles
      const double sigma = noise_of(run.values[c], std::size_t(channel.width)) *
                           (channel.kind == RecordedChannel::Kind::orientation ? 2 : 1);
      if (std::isfinite(sigma)) found.push_back(sigma);
      double low = INFINITY, high = -INFINITY;
      for (const double value : run.values[c])
        if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
      range = std::max(range, high - low);
    }
    const double smallest = std::max(1e-4 * range, 1e-9);  // no sensor is better than that
    channel.sigma = found.empty() ? std::max(1e-2 * range, smallest) : std::max(median(found), smallest);
  }
}

}  // namespace pvg::diagnose
