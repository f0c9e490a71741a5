// The bootstrap against the normal interval of independent values, and against values that stay the same for a while.
#include "host/base/bootstrap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace pvg {
namespace {

TEST(Bootstrap, EqualValuesHaveNoWidthAndNoneHaveNoMean) {
  const std::vector<double> values(20, 0.7);
  const MeanInterval interval = bootstrap_mean(values, 5);
  EXPECT_DOUBLE_EQ(interval.mean, 0.7);
  EXPECT_NEAR(interval.low, 0.7, 1e-12);
  EXPECT_NEAR(interval.high, 0.7, 1e-12);
  EXPECT_TRUE(std::isnan(bootstrap_mean({}, 5).mean));
}

// half width 1.96 sigma / sqrt(n) = 0.0980 of 400 independent values
TEST(Bootstrap, OfIndependentValuesIsTheNormalInterval) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> values(400);
  for (double& value : values) value = normal(random);
  const MeanInterval interval = bootstrap_mean(values, 1);
  EXPECT_NEAR(0.5 * (interval.high - interval.low), 0.0980, 0.012);
  EXPECT_LT(interval.low, interval.mean);
  EXPECT_GT(interval.high, interval.mean);
}

// Runs of 20 equal values are 20 independent ones, not 400: the interval is sqrt(20) = 4.5 times as wide.
TEST(Bootstrap, LongStretchesSeeThatNeighboursAreAlike) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<double> values;
  for (int run = 0; run < 100; ++run) values.insert(values.end(), 20, normal(random));
  const MeanInterval independent = bootstrap_mean(values, 1), stretches = bootstrap_mean(values, 40);
  const double ratio = (stretches.high - stretches.low) / (independent.high - independent.low);
  EXPECT_GT(ratio, 3);
  EXPECT_LT(ratio, 6);
}

}  // namespace
}  // namespace pvg
