// What recordings could show: from an information matrix that can be inverted by hand.
#include "host/identify/search/identifiability.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg::diagnose {
namespace {

Candidate candidate(const std::string& name) {
  Candidate one;
  one.name = name;
  one.target = "hinge";
  one.parameters = {{"size", "N m", -10, 10, 0}};
  return one;
}

// Two candidates whose steps of 0.5 change the residuals by 10 times the noise each, with the cosine c between the
// changes; a third one is at right angles to both.
Signatures with_cosine(double c, const std::vector<const Candidate*>& candidates) {
  Signatures s;
  s.candidate = candidates;
  s.parameter = {0, 0, 0};
  s.step = {0.5, 0.5, 0.5};
  s.information = 100 * (Eigen::MatrixXd(3, 3) << 1, c, 0, c, 1, 0, 0, 0, 1).finished();
  return s;
}

TEST(Identifiability, SigmaIsTheStepOverItsChangeAndLargerBesideALookAlike) {
  const Candidate a = candidate("a"), b = candidate("b"), c = candidate("c");
  const std::vector<Showable> rows = identifiability(with_cosine(0.8, {&a, &b, &c}));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_NEAR(rows[0].sigma, 0.05, 1e-6);
  EXPECT_NEAR(rows[0].smallest, 0.15, 1e-6);
  EXPECT_EQ(rows[0].look_alike, &b);
  EXPECT_NEAR(rows[0].sigma_beside, 0.05 / 0.6, 1e-6);  // 1 / sqrt(1 - 0.8^2)
  EXPECT_NEAR(rows[2].sigma_beside, 0.05, 1e-6);
  EXPECT_EQ(text_of(rows[0]), "a at hinge: size from 0.15 N m, told from b at hinge from 0.25 N m");
}

TEST(Identifiability, WhatIsTheSameToFirstOrderIsNotTold) {
  const Candidate a = candidate("a"), b = candidate("b"), c = candidate("c");
  const std::vector<Showable> rows = identifiability(with_cosine(1, {&a, &b, &c}));
  EXPECT_EQ(text_of(rows[0]), "a at hinge: size from 0.15 N m, not told from b at hinge");
  EXPECT_TRUE(std::isfinite(rows[2].sigma_beside));
}

// With the cosine 0.98 a change of 20 times the noise leaves 20 sqrt(1 - 0.98^2) = 4, one of 10 leaves 2.
TEST(Identifiability, ALookAlikeIsToldTogetherWhereTheNamedOneIsSmall) {
  const Candidate a = candidate("a"), b = candidate("b"), c = candidate("c");
  const Signatures s = with_cosine(0.98, {&a, &b, &c});
  EXPECT_EQ(look_alikes(s, a, Eigen::VectorXd::Constant(1, 0.5)), std::vector<const Candidate*>{&b});
  EXPECT_TRUE(look_alikes(s, a, Eigen::VectorXd::Constant(1, 1.0)).empty());
}

}  // namespace
}  // namespace pvg::diagnose
