// Wilson's interval against values worked out by hand from his formula, z = 1.96.
#include <gtest/gtest.h>

#include "pipeline/commands/commands.hpp"

namespace pvg {
namespace {

TEST(WilsonInterval, IsWhatTheFormulaGives) {
  // 18 of 20: centre (0.9 + 0.09604) / 1.19207 = 0.83555, half width 1.95996 / 1.19207 sqrt(0.0045 + 0.0024010) =
  // 0.13656
  EXPECT_NEAR(wilson_interval(18, 20).low, 0.6990, 1e-4);
  EXPECT_NEAR(wilson_interval(18, 20).high, 0.9721, 1e-4);
  // all of n: low is n / (n + z^2)
  EXPECT_NEAR(wilson_interval(20, 20).low, 20 / 23.8415, 1e-4);
  EXPECT_EQ(wilson_interval(20, 20).high, 1);
  EXPECT_EQ(wilson_interval(0, 20).low, 0);
  EXPECT_NEAR(wilson_interval(0, 20).high, 1 - 20 / 23.8415, 1e-4);
}

TEST(WilsonInterval, NothingTriedTellsNothing) {
  EXPECT_EQ(wilson_interval(0, 0).low, 0);
  EXPECT_EQ(wilson_interval(0, 0).high, 1);
}

}  // namespace
}  // namespace pvg
