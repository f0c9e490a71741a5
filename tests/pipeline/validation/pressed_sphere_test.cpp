// The finite elements that judge the case hertz, against theory and published numbers.
#include "pipeline/validation/pressed_sphere.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

const PressedSphere LINEAR{0.05, 1e6, 0.3, true, 40};

// 4/3 E / (1 - nu^2) sqrt(R) d^1.5 (Hertz 1882)
double hertz(double d) { return 4.0 / 3 * 1e6 / (1 - 0.09) * std::sqrt(0.05) * std::pow(d, 1.5); }

TEST(PressedSphere, LinearElementsGiveTheForceThatLinearElementsOfOthersGave) {
  EXPECT_NEAR(pressing_force(LINEAR, 1e-3), 11.24, 0.005 * 11.24);
}

TEST(PressedSphere, TheSmallerTheIndentationTheNearerToHertz) {
  const double at_1 = pressing_force(LINEAR, 1e-3) / hertz(1e-3), at_4 = pressing_force(LINEAR, 2.5e-4) / hertz(2.5e-4);
  // the correction falls with the contact's radius, the root of the indentation: to about a half
  EXPECT_GT(at_4, 1.02);
  EXPECT_LT(at_4 - 1, 0.6 * (at_1 - 1));
}

TEST(PressedSphere, FiniteStrainsTakeForceAwayAndLessOfItTheSmallerTheyAre) {
  PressedSphere finite = LINEAR;
  finite.is_linear = false;
  finite.cells = 24;
  PressedSphere linear = LINEAR;
  linear.cells = 24;
  const auto loss = [&](double d) { return 1 - pressing_force(finite, d) / pressing_force(linear, d); };
  const double large = loss(1e-3), small = loss(1.25e-4);
  EXPECT_NEAR(large, 0.028, 0.004);
  EXPECT_LT(small, 0.5 * large);
  EXPECT_GT(small, 0);
}

}  // namespace
}  // namespace pvg
