// What is known of a parameter before any data
#include "host/identify/fit/prior.hpp"

#include <gtest/gtest.h>

namespace pvg::diagnose {
namespace {

Parameter gravity(bool is_habit) {
  Parameter p{"value", "m/s^2", 0.01, 1e4, 9.81, 1, 0.2};
  p.prior_is_habit = is_habit;
  return p;
}

// Near, both say the same; 18 deviations away what is stated is impossible, and a habit merely rare.
TEST(Prior, AHabitIsBrokenNowAndThenWhatIsStatedIsNot) {
  EXPECT_NEAR(prior_cost(gravity(true), 9.91), prior_cost(gravity(false), 9.91), 0.04);
  EXPECT_NEAR(prior_cost(gravity(false), 6.15), 167, 1);
  EXPECT_LT(prior_cost(gravity(true), 6.15), 12);
  EXPECT_GT(prior_cost(gravity(true), 6.15), 8);
}

TEST(Prior, TheWeightIsTheGradientOverTheDistance) {
  for (const bool is_habit : {false, true})
    for (const double x : {9.7, 9.0, 6.0, 30.0}) {
      const Parameter p = gravity(is_habit);
      const double slope = (prior_cost(p, x + 1e-5) - prior_cost(p, x - 1e-5)) / 2e-5;
      EXPECT_NEAR(prior_weight(p, x) * (x - p.off), slope, 1e-5 * std::abs(slope)) << is_habit << " " << x;
    }
}

TEST(Prior, WhereNothingIsKnownTheBoundsAreTheWidth) {
  Parameter p = gravity(true);
  p.prior_sigma = 0;
  EXPECT_LT(prior_cost(p, p.high), 0.51);
}

}  // namespace
}  // namespace pvg::diagnose
