#include "host/base/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "host/base/hash.hpp"

namespace pvg {

MeanInterval bootstrap_mean(std::span<const double> values, std::size_t stretch, std::size_t n_resamples) {
  const std::size_t n = values.size();
  constexpr double NOTHING = std::numeric_limits<double>::quiet_NaN();
  if (n == 0) return {NOTHING, NOTHING, NOTHING};
  stretch = std::clamp<std::size_t>(stretch, 1, n);
  std::vector<double> means(n_resamples);
  std::uint64_t counter = 0;
  for (double& mean : means) {
    double sum = 0;
    for (std::size_t taken = 0; taken < n;) {
      const std::size_t start = std::size_t(mixed_bits(counter++) % n);
      for (std::size_t k = 0; k < stretch && taken < n; ++k, ++taken) sum += values[(start + k) % n];
    }
    mean = sum / double(n);
  }
  std::sort(means.begin(), means.end());
  const auto quantile = [&](double share) { return means[std::size_t(share * double(n_resamples - 1) + 0.5)]; };
  return {std::accumulate(values.begin(), values.end(), 0.0) / double(n), quantile(0.025), quantile(0.975)};
}

}  // namespace pvg
