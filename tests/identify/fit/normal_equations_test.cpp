#include "host/identify/fit/normal_equations.hpp"

#include <gtest/gtest.h>

namespace pvg::diagnose {
namespace {

using Eigen::Matrix2d, Eigen::Matrix3d, Eigen::MatrixXd;

// A play known to 1e-5 m and a modulus known to 1e5 Pa, which hang together by a correlation of 0.6 in the information:
// variances are those of each alone over 1 - 0.36.
TEST(NormalEquations, InvertsNumbersOfAnyUnits) {
  const Matrix2d a{{1e10, 0.6}, {0.6, 1e-10}};
  const MatrixXd inverse = inverse_in_own_units(a);
  EXPECT_NEAR(inverse(0, 0), 1e-10 / 0.64, 1e-21);
  EXPECT_NEAR(inverse(1, 1), 1e10 / 0.64, 1e-1);
  EXPECT_NEAR(inverse(0, 1), -0.6 / 0.64, 1e-11);
}

TEST(NormalEquations, WhatNothingDependsOnStaysAndTheOthersAreAsWithoutIt) {
  Matrix3d a = Matrix3d::Zero();
  a(0, 0) = 4, a(2, 2) = 1e-8;
  const MatrixXd inverse = inverse_in_own_units(a);
  EXPECT_DOUBLE_EQ(inverse(0, 0), 0.25);
  EXPECT_EQ(inverse(1, 1), 0);
  EXPECT_NEAR(inverse(2, 2), 1e8, 1e-6);
  MatrixXd damped = a;
  add_to_diagonal(damped, 0.5);
  EXPECT_DOUBLE_EQ(damped(0, 0), 6);
  EXPECT_DOUBLE_EQ(damped(1, 1), 1);
  EXPECT_DOUBLE_EQ(damped(2, 2), 1.5e-8);
}

}  // namespace
}  // namespace pvg::diagnose
