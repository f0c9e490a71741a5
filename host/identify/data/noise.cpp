#include "host/identify/data/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/identify/criteria.hpp"

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
  if (steps.size() < criteria().quantum_n_least) return 0;
  const double least = *std::min_element(steps.begin(), steps.end());
  const auto whole = std::count_if(steps.begin(), steps.end(), [&](double step) {
    return std::abs(step / least - std::round(step / least)) < criteria().quantum_near_whole &&
           step / least < criteria().quantum_n_most;
  });
  return whole > criteria().quantum_share * double(steps.size()) ? least : 0;
}

constexpr double TYPICAL = 1.4826;  // sigma of a normal distribution over the median of its size

// 1, 2, 3, 4, 6, 8, ...: powers of two and the whole numbers half way between them, as distances of samples.
std::vector<unsigned> lags() {
  std::vector<unsigned> all;
  for (unsigned power = 1; power <= criteria().noise_lag_most; power *= 2) {
    all.push_back(power);
    if (power > 1 && power + power / 2 <= criteria().noise_lag_most) all.push_back(power + power / 2);
  }
  return all;
}

struct Differences {
  double sigma = 0;        // of white noise that would make them
  double correlation = 0;  // of neighbours
};

// Third differences of samples `lag` apart. Their correlation uses sizes cut at noise_cut, since an impact is in four
// of them.
std::optional<Differences> third_differences(const std::vector<double>& values, std::size_t width, std::size_t lag) {
  const std::size_t step = lag * width;
  std::vector<double> difference, size;
  for (std::size_t i = 3 * step; i < values.size(); ++i) {
    difference.push_back(values[i] - 3 * values[i - step] + 3 * values[i - 2 * step] - values[i - 3 * step]);
    if (std::isfinite(difference.back())) size.push_back(std::abs(difference.back()));
  }
  if (size.size() < (lag == 1 ? criteria().noise_n_neighbours : criteria().noise_n_apart)) return std::nullopt;
  Differences found;
  const double typical = TYPICAL * median(std::move(size));
  const double most = criteria().noise_cut * typical;
  found.sigma = typical / std::sqrt(20.0);
  double product = 0, square = 0;
  for (std::size_t i = step; i < difference.size(); ++i) {
    const double a = std::clamp(difference[i], -most, most), b = std::clamp(difference[i - step], -most, most);
    if (!std::isfinite(difference[i] * difference[i - step])) continue;
    product += a * b;
    square += 0.5 * (a * a + b * b);
  }
  found.correlation = square > 0 ? product / square : criteria().noise_white_correlation;
  return found;
}

// pictures come less often than rows
std::vector<double> without_gaps(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return values;
}

// Of white noise, where the correlation is below noise_white_correlation; else of a motion, or of too few samples
// (sigma: NaN).
Differences differences_of(const std::vector<double>& values, std::size_t width) {
  std::vector<Differences> found;
  for (const unsigned lag : lags()) {
    const std::optional<Differences> here = third_differences(values, width, lag);
    if (here) found.push_back(*here);
    if (!here || here->correlation >= 0) break;  // a motion shows
  }
  if (found.empty()) return {std::nan(""), 0};
  const auto hangs_less = [](const Differences& a, const Differences& b) { return a.correlation < b.correlation; };
  Differences noise = *std::min_element(found.begin(), found.end(), hangs_less);
  if (noise.correlation < criteria().noise_white_correlation) {
    const Differences neighbours = found.front();
    std::erase_if(found, [](const Differences& one) { return one.correlation >= criteria().noise_white_correlation; });
    noise = *std::max_element(found.begin(), found.end(),
                              [](const Differences& a, const Differences& b) { return a.sigma < b.sigma; });
    if (neighbours.correlation < criteria().noise_white_correlation &&
        noise.sigma < criteria().noise_smoothed * neighbours.sigma)
      noise = neighbours;
  }
  noise.sigma = std::max(noise.sigma, quantum_of(values, width) / std::sqrt(12.0));
  return noise;
}

}  // namespace

double noise_of(const std::vector<double>& values, std::size_t width) { return differences_of(values, width).sigma; }

void measure_noise(Problem& problem) {
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    Channel& channel = problem.channels[c];
    const NoiseModel& model = channel.sensor->noise;
    if (channel.is_noise_known) continue;
    std::vector<double> found;
    std::vector<Differences> of_run;
    double range = 0, brightest = 0;
    for (const Run& run : problem.runs) {
      Differences noise =
          differences_of(model.has_gaps ? without_gaps(run.values[c]) : run.values[c], std::size_t(channel.width));
      noise.sigma *= model.per_number;
      if (std::isfinite(noise.sigma)) found.push_back(noise.sigma);
      of_run.push_back(noise);
      double low = INFINITY, high = -INFINITY;
      for (const double value : run.values[c])
        if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
      range = std::max(range, high - low);
      brightest = std::max(brightest, high);
    }
    const double smallest = std::max(criteria().noise_least * range, criteria().noise_floor);
    channel.is_noise_assumed = found.empty();
    channel.sigma =
        found.empty() ? std::max(criteria().noise_assumed * range, smallest) : std::max(median(found), smallest);
    if (model.rounding != nullptr) channel.sigma = std::hypot(channel.sigma, model.rounding(brightest));
    for (std::size_t r = 0; r < problem.runs.size(); ++r)
      if (of_run[r].correlation < criteria().noise_white_correlation &&
          of_run[r].sigma > criteria().run_noise_scale * channel.sigma)
        problem.runs[r].noise_scale[c] = of_run[r].sigma / channel.sigma;
  }
}

}  // namespace pvg::diagnose
