#include "host/identify/data/noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "host/base/statistics.hpp"
#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

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
  double least = 0;        // the sigma of what is in all frequencies; of few samples that of neighbours
  double rounding = 0;     // that of their last digit
  bool is_seen() const {
    return correlation < criteria().noise_white_correlation && sigma > criteria().noise_over_digits * rounding;
  }
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
  const double typical = SIGMA_OVER_MEDIAN * upper_median(std::move(size));
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

// The sigma of white noise that is in every frequency from fs / 8 on: the median over these of the power of third
// differences, by segments under a Hann window, over what differences make of white noise, (2 sin(w / 2))^6. A sensor
// that smooths and a body that trembles both have frequencies with more. NaN: too few samples.
double noise_of_all_frequencies(const std::vector<double>& values, std::size_t width) {
  const std::size_t n = criteria().noise_segment, n_bins = n / 2, first_bin = n / 8;
  std::vector<double> power(n_bins, 0), window(n);
  double weight = 0;
  for (std::size_t i = 0; i < n; ++i) {
    window[i] = std::sin(std::numbers::pi * (double(i) + 0.5) / double(n));
    window[i] *= window[i];
    weight += window[i] * window[i];
  }
  double n_segments = 0;
  const auto difference = [&](std::size_t sample, std::size_t k) {
    const double* at = &values[sample * width + k];
    return at[3 * width] - 3 * at[2 * width] + 3 * at[width] - at[0];
  };
  for (std::size_t begin = 0; (begin + n + 3) * width <= values.size(); begin += n / 2)
    for (std::size_t k = 0; k < width; ++k) {
      std::vector<double> seen(n);
      for (std::size_t i = 0; i < n; ++i) seen[i] = window[i] * difference(begin + i, k);
      if (!std::all_of(seen.begin(), seen.end(), [](double value) { return std::isfinite(value); })) continue;
      ++n_segments;
      for (std::size_t bin = first_bin; bin < n_bins; ++bin) {
        std::complex<double> sum = 0;
        for (std::size_t i = 0; i < n; ++i)
          sum += std::polar(seen[i], -2 * std::numbers::pi * double(bin * i) / double(n));
        power[bin] += std::norm(sum) / weight;
      }
    }
  if (n_segments == 0) return std::nan("");
  std::vector<double> density;
  for (std::size_t bin = first_bin; bin < n_bins; ++bin)
    density.push_back(power[bin] / n_segments / std::pow(2 * std::sin(std::numbers::pi * double(bin) / double(n)), 6));
  return std::sqrt(upper_median(std::move(density)));
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
  if (found.empty()) return {std::nan(""), 0, 0, 0};
  const Differences neighbours = found.front();
  const auto hangs_less = [](const Differences& a, const Differences& b) { return a.correlation < b.correlation; };
  Differences noise = *std::min_element(found.begin(), found.end(), hangs_less);
  if (noise.correlation < criteria().noise_white_correlation) {
    std::erase_if(found, [](const Differences& one) { return one.correlation >= criteria().noise_white_correlation; });
    noise = *std::max_element(found.begin(), found.end(),
                              [](const Differences& a, const Differences& b) { return a.sigma < b.sigma; });
    if (neighbours.correlation < criteria().noise_white_correlation &&
        noise.sigma < criteria().noise_smoothed * neighbours.sigma)
      noise = neighbours;
  }
  const double rounding = noise.rounding = quantum_of(values, width) / std::sqrt(12.0);
  noise.sigma = std::max(noise.sigma, rounding);
  const double least = noise_of_all_frequencies(values, width);
  noise.least = std::max(std::isfinite(least) ? least : neighbours.sigma, rounding);
  return noise;
}

}  // namespace

std::vector<double> own_samples(const std::vector<double>& t, const std::vector<double>& values, std::size_t width) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::any_of(&values[i * width], &values[i * width] + width, [](double v) { return std::isfinite(v); }))
      rows.push_back(i);
  std::vector<double> spacing;
  for (std::size_t i = 1; i < rows.size(); ++i) spacing.push_back(t[rows[i]] - t[rows[i - 1]]);
  const double usual = spacing.empty() ? 1 : upper_median(spacing);
  std::vector<double> own;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // beyond the reach of a difference it does not matter how many are missing
    const double n_steps = i > 0 ? std::min(std::round(spacing[i - 1] / usual), 4.0 * criteria().noise_lag_most) : 1;
    for (double missing = 1; missing < n_steps; ++missing) own.insert(own.end(), width, std::nan(""));
    own.insert(own.end(), &values[rows[i] * width], &values[rows[i] * width] + width);
  }
  return own;
}

double noise_of(const std::vector<double>& values, std::size_t width) { return differences_of(values, width).sigma; }

namespace {

// Of one channel over all runs.
struct Extent {
  double range = 0, brightest = 0;
};

Extent extent_of(const Problem& problem, std::size_t c) {
  Extent extent;
  for (const Run& run : problem.runs) {
    double low = INFINITY, high = -INFINITY;
    for (const double value : run.values[c])
      if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
    extent.range = std::max(extent.range, high - low);
    extent.brightest = std::max(extent.brightest, high);
  }
  return extent;
}

// Whether a run was commanded, row for row, what another was.
bool repeats(const Run& a, const Run& b) {
  if (!a.pushes.empty() || !b.pushes.empty()) return false;
  if (a.t.size() != b.t.size() || (a.targets.empty() && a.prescribed.empty())) return false;
  const auto is_near = [](double x, double y) { return std::abs(x - y) < 1e-9; };
  bool changes = false;
  for (std::size_t i = 0; i < a.t.size(); ++i)
    if (!is_near(a.t[i] - a.t[0], b.t[i] - b.t[0])) return false;
  for (std::size_t d = 0; d < a.targets.size(); ++d) {
    const std::vector<double>&x = a.targets[d].value, &y = b.targets[d].value;
    if (!std::equal(x.begin(), x.end(), y.begin(), y.end(), is_near)) return false;
    changes = changes || std::any_of(x.begin(), x.end(), [&](double value) { return value != x[0]; });
  }
  for (std::size_t p = 0; p < a.prescribed.size(); ++p) {
    const std::vector<PathPoint>&x = a.prescribed[p].path, &y = b.prescribed[p].path;
    if (!std::equal(x.begin(), x.end(), y.begin(), y.end(),
                    [](const PathPoint& m, const PathPoint& n) { return m.pose.isApprox(n.pose, 1e-9); }))
      return false;
    changes = true;
  }
  return changes;
}

// What two runs of the same commands do not share is noise: of independent noise their difference has the variance
// 2 sigma^2. The median over such pairs; NaN: there are none.
double noise_of_repeats(const Problem& problem, std::size_t c) {
  const std::size_t width = std::size_t(problem.channels[c].width);
  std::vector<double> found;
  for (std::size_t a = 0; a < problem.runs.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const Run &one = problem.runs[a], &other = problem.runs[b];
      if (!repeats(one, other)) continue;
      std::vector<double> difference = one.values[c];
      for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= other.values[c][i];
      const double sigma = differences_of(own_samples(one.t, difference, width), width).sigma / std::sqrt(2.0);
      if (std::isfinite(sigma)) found.push_back(sigma);
    }
  return upper_median(std::move(found));
}

}  // namespace

void measure_noise(Problem& problem) {
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    Channel& channel = problem.channels[c];
    const NoiseModel& model = channel.sensor->noise;
    if (channel.is_noise_known) continue;
    const std::size_t width = std::size_t(channel.width);
    std::vector<double> found, least;
    std::vector<Differences> of_run;
    bool is_seen = true;
    for (const Run& run : problem.runs) {
      Differences noise = differences_of(own_samples(run.t, run.values[c], width), width);
      is_seen = is_seen && noise.is_seen();
      noise.sigma *= model.per_number;
      noise.least *= model.per_number;
      if (std::isfinite(noise.sigma)) found.push_back(noise.sigma), least.push_back(noise.least);
      of_run.push_back(noise);
    }
    const auto [range, brightest] = extent_of(problem, c);
    const double smallest = std::max({(is_seen ? criteria().noise_least_white : criteria().noise_least) * range,
                                      criteria().noise_floor, rounding_noise(channel.readout)});
    channel.is_noise_assumed = found.empty();
    channel.sigma =
        found.empty() ? std::max(criteria().noise_assumed * range, smallest) : std::max(upper_median(found), smallest);
    channel.least_sigma = found.empty() ? smallest : std::max(upper_median(least), smallest);
    const double repeated = model.per_number * noise_of_repeats(problem, c);
    channel.is_noise_of_repeats = repeated < channel.sigma;
    if (channel.is_noise_of_repeats) {
      channel.sigma = channel.least_sigma = std::max(repeated, smallest);
      channel.is_noise_assumed = false;
    }
    if (channel.least_sigma * criteria().noise_smoothed > channel.sigma) channel.least_sigma = 0;
    if (model.rounding != nullptr) channel.sigma = std::hypot(channel.sigma, model.rounding(brightest));
    for (std::size_t r = 0; r < problem.runs.size(); ++r)
      if (!channel.is_noise_of_repeats && of_run[r].correlation < criteria().noise_white_correlation &&
          of_run[r].sigma > criteria().run_noise_scale * channel.sigma)
        problem.runs[r].noise_scale[c] = of_run[r].sigma / channel.sigma;
  }
}

std::string noise_sentence(const Channel& channel) {
  const std::string noise = fmt::format("noise of the {}: {:.3g} {}", channel.name, channel.sigma, channel.unit);
  if (channel.is_noise_known) return noise + ", as given";
  if (channel.is_noise_assumed)
    return noise + ", taken as a hundredth of the range: too few neighbouring samples to measure it";
  if (channel.is_noise_of_repeats) return noise + ", measured as what runs of the same commands do not share";
  if (channel.least_sigma == 0) return noise + ", measured from third differences";
  return fmt::format(
      "{}, measured from third differences; no more than {:.3g} {} is in all frequencies: either the sensor smooths, "
      "or "
      "what it measures trembles, which is no noise. Give the noise, or record a run twice",
      noise, channel.least_sigma, channel.unit);
}

std::string suppose_less_noise(Problem& problem, double error) {
  std::string supposed;
  for (Channel& channel : problem.channels) {
    const double less = std::max(channel.least_sigma, channel.sigma * error / criteria().noise_supposed);
    if (channel.least_sigma == 0 || less >= channel.sigma) continue;
    supposed +=
        fmt::format("{}the noise of the {} is unknown: with {:.3g} {} scene and runs agree, with {:.3g} {}",
                    supposed.empty() ? "" : "; ", channel.name, channel.sigma, channel.unit, less, channel.unit);
    channel.sigma = less;
  }
  return supposed;
}

}  // namespace pvg::diagnose
