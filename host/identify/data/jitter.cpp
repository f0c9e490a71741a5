#include "host/identify/data/jitter.hpp"

#include <algorithm>
#include <cmath>

namespace pvg::diagnose {
namespace {

constexpr std::size_t N_OF_TURN = 4;  // numbers of a quaternion

// Rates of the numbers that are compared; of a turn, whose quaternion changes by half of it, each at most its rate.
double rate_between(const double* a, const double* b, std::size_t width, std::size_t component, double dt) {
  if (width < N_OF_TURN) return std::abs(b[component] - a[component]) / dt;
  double apart = 0, across = 0;  // a quaternion and its negative are one turn
  for (std::size_t k = 0; k < width; ++k) apart += std::pow(b[k] - a[k], 2), across += std::pow(b[k] + a[k], 2);
  return 2 * std::sqrt(std::min(apart, across)) / dt;
}

}  // namespace

std::vector<double> jitter_noise(const Channel& channel, const std::vector<double>& t,
                                 const std::vector<double>& values) {
  if (channel.jitter <= 0) return {};
  const std::size_t width = std::size_t(channel.width), n = std::size_t(channel.n);
  std::vector<std::size_t> own;  // rows that are whole samples of the channel
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::all_of(&values[i * width], &values[i * width] + width, [](double v) { return std::isfinite(v); }))
      own.push_back(i);
  std::vector<double> noise(t.size() * n, 0);
  for (std::size_t k = 0; k < own.size() && own.size() > 1; ++k) {
    const std::size_t before = own[k > 0 ? k - 1 : 0], after = own[std::min(k + 1, own.size() - 1)];
    for (std::size_t c = 0; c < n; ++c)
      noise[own[k] * n + c] = channel.jitter * rate_between(&values[before * width], &values[after * width], width, c,
                                                            t[after] - t[before]);
  }
  return noise;
}

double noise_of_number(const Problem& problem, const Run& run, std::size_t channel, std::size_t sample, int component) {
  const double noise = noise_in(problem, run, channel);
  if (run.jitter_noise.empty() || run.jitter_noise[channel].empty()) return noise;
  const std::size_t n = std::size_t(problem.channels[channel].n);
  return std::hypot(noise, run.jitter_noise[channel][sample * n + std::size_t(component)]);
}

double noise_around(const Problem& problem, const Run& run, std::size_t channel, double t0) {
  double largest = noise_in(problem, run, channel);
  const std::size_t next = std::size_t(std::lower_bound(run.t.begin(), run.t.end(), t0) - run.t.begin()),
                    n = run.t.size();
  for (std::size_t i = next > 0 ? next - 1 : 0; i < std::min(next + 2, n); ++i)
    for (int k = 0; k < problem.channels[channel].n; ++k)
      largest = std::max(largest, noise_of_number(problem, run, channel, i, k));
  return largest;
}

}  // namespace pvg::diagnose
