#include "host/base/correlation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pvg {
namespace {

constexpr double NORMAL_95 = 1.959963984540054;  // quantile of the normal distribution, two-sided 95 %

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / double(values.size());
}

// of the mean, from the unbiased variance
double variance_of_mean(std::span<const double> values) {
  const double mean = mean_of(values);
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return values.size() < 2 ? std::numeric_limits<double>::quiet_NaN()
                           : sum / double(values.size() - 1) / double(values.size());
}

}  // namespace

double pearson_correlation(std::span<const double> a, std::span<const double> b) {
  const double mean_a = mean_of(a), mean_b = mean_of(b);
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);  // 0 / 0 where one does not vary
}

double mean_rank_violation(std::span<const double> predicted, std::span<const double> real) {
  double sum = 0;
  for (std::size_t i = 0; i < real.size(); ++i) {
    double largest = 0;
    for (std::size_t j = 0; j < real.size(); ++j)
      if ((predicted[i] < predicted[j]) != (real[i] < real[j]))
        largest = std::max(largest, std::abs(real[i] - real[j]));
    sum += largest;
  }
  return sum / double(real.size());
}

RectifiedMean rectified_mean(std::span<const double> all_predicted, std::span<const double> predicted,
                             std::span<const double> real) {
  std::vector<double> error(real.size());
  for (std::size_t i = 0; i < real.size(); ++i) error[i] = real[i] - predicted[i];
  const double mean = mean_of(all_predicted) + mean_of(error);
  const double half = NORMAL_95 * std::sqrt(variance_of_mean(all_predicted) + variance_of_mean(error));
  return {mean, mean - half, mean + half};
}

}  // namespace pvg
