#include "host/base/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pvg {
namespace {

constexpr double NORMAL_QUANTILE = 1.959963984540054;  // of 97.5 %: an interval of 95 %

}  // namespace

RateInterval wilson_interval(std::size_t successes, std::size_t n) {
  if (n == 0) return {0, 1};
  const double z = NORMAL_QUANTILE, total = double(n), rate = double(successes) / total;
  const double center = (rate + z * z / (2 * total)) / (1 + z * z / total);
  const double half = z / (1 + z * z / total) * std::sqrt(rate * (1 - rate) / total + z * z / (4 * total * total));
  return {std::max(0.0, center - half), std::min(1.0, center + half)};
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace pvg
