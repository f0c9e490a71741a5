// Against SimplerEnv's published tables and numbers by hand.
#include "host/base/correlation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace pvg {
namespace {

// Success of RT-1 (converged, 15 %), RT-1-X, RT-2-X, Octo, RT-1 (begin) in simulation with visual matching, and real
// (Li et al. 2024, table of the Google robot), with the figures that it gives for them.
struct Published {
  std::vector<double> simulated, real;
  double pearson, violation;
};
const Published PICK_COKE_CAN = {
    {0.857, 0.710, 0.567, 0.787, 0.170, 0.027}, {0.853, 0.920, 0.760, 0.907, 0.293, 0.133}, 0.975, 0.031};
const Published MOVE_NEAR = {
    {0.442, 0.354, 0.317, 0.779, 0.042, 0.050}, {0.633, 0.583, 0.450, 0.733, 0.350, 0.017}, 0.856, 0.111};

TEST(Correlation, PublishedTablesHaveTheirPublishedFigures) {
  for (const Published& table : {PICK_COKE_CAN, MOVE_NEAR}) {
    EXPECT_NEAR(pearson_correlation(table.simulated, table.real), table.pearson, 5.1e-4);
    EXPECT_NEAR(mean_rank_violation(table.simulated, table.real), table.violation, 5.1e-4);
  }
}

TEST(Correlation, OrderAndScaleCountAsTheyShould) {
  const std::vector<double> real = {0.1, 0.5, 0.9};
  EXPECT_NEAR(pearson_correlation(std::vector<double>{0.2, 0.4, 0.6}, real), 1, 1e-12);
  EXPECT_NEAR(mean_rank_violation(std::vector<double>{0.2, 0.4, 0.6}, real), 0, 0);
  // all in reverse: 0.8, 0.4 and 0.8 are the largest violations
  EXPECT_NEAR(mean_rank_violation(std::vector<double>{0.6, 0.4, 0.2}, real), 2.0 / 3, 1e-12);
  EXPECT_TRUE(std::isnan(pearson_correlation(std::vector<double>{0.5, 0.5, 0.5}, real)));
}

TEST(Correlation, ARectifiedMeanIsThePredictionCorrectedByTheKnownError) {
  // predictions are 0.2 too high where reality is known: errors -0.1 and -0.3, variance of their mean 0.01
  const std::vector<double> all = {0.4, 0.8, 0.6, 0.6}, known = {0.4, 0.8}, real = {0.3, 0.5};
  const RectifiedMean rectified = rectified_mean(all, known, real);
  EXPECT_NEAR(rectified.mean, 0.4, 1e-12);
  // variance of the predictions 0.08 / 3, of their mean a quarter of it
  const double half = 1.959963984540054 * std::sqrt(0.08 / 12 + 0.01);
  EXPECT_NEAR(rectified.high - rectified.mean, half, 1e-12);
  EXPECT_NEAR(rectified.mean - rectified.low, half, 1e-12);
  EXPECT_TRUE(std::isnan(rectified_mean(all, std::array{0.4}, std::array{0.3}).low));
}

}  // namespace
}  // namespace pvg
