#include "host/identify/search/pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg::diagnose {
namespace {

Candidate one(const char* name, double low) {
  Candidate candidate;
  candidate.name = name;
  candidate.parameters = {{"strength", "1", low, 100, 0, 1}};
  return candidate;
}

// Four samples, one number each that is misfit by (2, 1, 0, 0): the first two candidates together take it away; the
// third is the best alone, the fourth could do it beside the third if its strength were negative.
struct FourCandidates {
  std::vector<Candidate> candidates = {one("a", 0), one("b", 0), one("stand_in", 0), one("against", 0)};
  Signatures signatures;
  FourCandidates() {
    Eigen::Matrix4d columns;
    columns.col(0) << 1, 0, 0, 0;
    columns.col(1) << 0, 1, 0, 0;
    columns.col(2) << 2, 1, 0.5, 0;
    columns.col(3) << 0, 0, 0.5, 0;
    for (std::size_t i = 0; i < 4; ++i) {
      signatures.candidate.push_back(&candidates[i]);
      signatures.parameter.push_back(0);
      signatures.step.push_back(0.5);
    }
    signatures.a = columns.transpose() * columns;
    signatures.g = -columns.transpose() * Eigen::Vector4d(2, 1, 0, 0);
  }
};

TEST(Pairs, WhatExplainsTogetherComesFirstThoughAnotherIsBetterAlone) {
  const FourCandidates four;
  const std::vector<Pair> best = best_pairs(four.signatures, 1);
  ASSERT_FALSE(best.empty());
  EXPECT_EQ(best[0].first->name + " " + best[0].second->name, "a b");
  EXPECT_NEAR(best[0].gain, 2.5, 1e-5);      // half of 2^2 + 1^2
  EXPECT_NEAR(best[0].model.x[0], 1, 1e-5);  // two steps of 0.5
  EXPECT_NEAR(best[0].model.x[1], 0.5, 1e-5);
  for (const Pair& pair : best) EXPECT_LT(pair.gain, pair.second->name == "against" ? 2.45 : 2.51);
}

TEST(Pairs, OfMoreDataThanTheyExplainAreNone) {
  const FourCandidates four;
  EXPECT_TRUE(best_pairs(four.signatures, std::exp(3)).empty());  // two parameters cost 3 there
}

TEST(Pairs, NoCandidateStandsInAllOfThem) {
  const FourCandidates four;
  std::size_t n_of_first = 0;
  std::vector<Candidate> many;
  for (int i = 0; i < 9; ++i) many.push_back(one("other", -100));
  Signatures s;
  const std::size_t n = many.size();
  s.a = Eigen::MatrixXd::Identity(n, n);
  s.g = Eigen::VectorXd::Constant(n, -1);
  s.g[0] = -10;
  for (std::size_t i = 0; i < n; ++i) {
    s.candidate.push_back(&many[i]);
    s.parameter.push_back(0);
    s.step.push_back(1);
  }
  const std::vector<Pair> best = best_pairs(s, 1);
  EXPECT_EQ(best.size(), criteria().n_pairs);
  for (const Pair& pair : best) n_of_first += pair.first == &many[0];
  EXPECT_EQ(n_of_first, criteria().n_pairs_of_one);
}

}  // namespace
}  // namespace pvg::diagnose
