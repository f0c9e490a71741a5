// Statistics of samples.
#pragma once
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace pvg {

struct RateInterval {
  double low = 0, high = 1;
};
// Of a rate seen as `successes` in n trials, 95 %; 0 to 1 for no trial. Wilson 1927, "Probable inference, the law of
// succession, and statistical inference".
RateInterval wilson_interval(std::size_t successes, std::size_t n);

// The middle value, of an even number the mean of the two in the middle; of none, NaN.
double median(std::vector<double> values);

// The middle value, of an even number the upper of the two; of none, NaN. Linear time.
template <typename Number>
Number upper_median(std::vector<Number> values) {
  if (values.empty()) return std::numeric_limits<Number>::quiet_NaN();
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Standard deviation of a normal distribution over the median of its magnitude: 1 / 0.6745 (Huber 1981, "Robust
// statistics", section 5.1). Times upper_median() it estimates a scale that outliers hardly move.
inline constexpr double SIGMA_OVER_MEDIAN = 1.4826;

}  // namespace pvg
