// Whether residuals are noise: by their size, and by what hangs together in long blocks of them.
#include "host/identify/fit/agreement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/correlation.hpp"
#include "host/identify/fit/whole_runs.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

Problem one_channel(bool is_noise_known, std::size_t n) {
  Problem problem;
  problem.channels.resize(1);
  problem.channels[0].name = "angle";
  problem.channels[0].is_noise_known = is_noise_known;
  diagnose::Run run;
  run.values = {std::vector<double>(n, 0.0)};
  problem.runs = {run};
  return problem;
}

// n samples, whose time step is exact
std::vector<Window> one_window(std::size_t n) {
  Window window;
  for (std::size_t i = 0; i < n; ++i) window.data.push_back({0, i, 0});
  window.correction = VectorXd::Zero(Eigen::Index(n));
  return {window};
}

VectorXd white(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  VectorXd values(static_cast<Eigen::Index>(n));
  for (double& value : values) value = normal(random);
  return values;
}

bool agrees(const Problem& problem, const VectorXd& residual, const std::vector<Window>& windows) {
  return agreement_of(problem, windows, {residual}).is_agreement;
}

TEST(Agreement, WhiteNoiseOfTheGivenSizeAgrees) {
  const std::size_t n = 4000;
  for (unsigned seed = 0; seed < 200; ++seed)
    EXPECT_TRUE(agrees(one_channel(true, n), white(n, seed), one_window(n))) << seed;
}

// 4000 samples tell their standard deviation to 1.1 %; a given noise counts as known to 2 %.
TEST(Agreement, AnErrorOf109HundredthsOfAGivenNoiseIsAMisfit) {
  const std::size_t n = 4000;
  for (unsigned seed = 0; seed < 50; ++seed)
    EXPECT_FALSE(agrees(one_channel(true, n), 1.09 * white(n, seed), one_window(n))) << seed;
  EXPECT_TRUE(agrees(one_channel(true, 100), 1.09 * white(100, 1), one_window(100))) << "100 samples do not tell";
}

// Criteria are varied for studies: a block of less than a sample once had none, and the loop over it no end.
TEST(Agreement, ABlockShorterThanASampleIsASample) {
  const std::size_t n = 400;
  set_criterion("agreement_blocks", 0.4);
  EXPECT_TRUE(agrees(one_channel(true, n), white(n, 0), one_window(n)));
  set_criterion("agreement_blocks", 1);
}

// A drift of a third of the noise: the samples' mean square grows by 6 % only, the blocks of 256 show it.
TEST(Agreement, ASlowDriftShowsInLongBlocks) {
  const std::size_t n = 2000;
  VectorXd residual = white(n, 3);
  for (Eigen::Index i = 0; i < residual.size(); ++i) residual[i] += 0.35 * std::sin(2 * M_PI * double(i) / double(n));
  const Agreement found = agreement_of(one_channel(true, n), one_window(n), {residual});
  EXPECT_FALSE(found.is_agreement);
  EXPECT_GE(found.n_block, 64u);
  EXPECT_EQ(found.channel, "angle");
}

// A noise that was measured from 400 samples is good to 1.53 / 20 = 7.7 %, so 1.1 times it is no misfit.
TEST(Agreement, AMeasuredNoiseIsKnownAsWellAsItsSamplesTell) {
  EXPECT_NEAR(noise_uncertainty(one_channel(false, 400), 0), 0.077, 0.002);
  const std::size_t n = 400;
  EXPECT_TRUE(agrees(one_channel(false, n), 1.1 * white(n, 5), one_window(n)));
}

// What a halving of the step changes by 1 may be wrong by a tenth.
TEST(Agreement, TheErrorOfTheTimeStepBelongsToTheNoise) {
  const std::size_t n = 2000;
  std::vector<Window> windows = one_window(n);
  VectorXd error(static_cast<Eigen::Index>(n));
  for (Eigen::Index i = 0; i < error.size(); ++i) error[i] = 6 * std::sin(2 * M_PI * double(i) / double(n));
  const VectorXd residual = white(n, 7) + 0.08 * error;
  EXPECT_FALSE(agrees(one_channel(true, n), residual, windows));
  windows[0].correction = error;
  EXPECT_TRUE(agrees(one_channel(true, n), residual, windows));
}

// Each number thrice: 1 + 2 (2/3 + 1/3) = 3.
TEST(Correlation, NumbersThatAreRepeatedCountOnce) {
  const std::size_t n = 9000;
  const VectorXd noise = white(n, 9);
  VectorXd residual(static_cast<Eigen::Index>(n));
  for (Eigen::Index i = 0; i < residual.size(); ++i) residual[i] = noise[i / 3];
  EXPECT_NEAR(correlation_length(one_window(n), {residual}), 3, 0.2);
  EXPECT_NEAR(correlation_length(one_window(n), {noise}), 1, 0.1);
}

// A rate that is measured to 1/20 of its sigma, after one second: 60 / 20 at the end, and 7/8 of that in the last
// quarter on average.
TEST(WholeRuns, TheErrorOfAStartGrows) {
  Eigen::MatrixXd of_start(1000, 1);
  for (Eigen::Index i = 0; i < 1000; ++i) of_start(i, 0) = 60e-3 * double(i);
  EXPECT_NEAR(start_growth(of_start), 60 * 0.878 / 20, 0.01);
}

}  // namespace
}  // namespace pvg::diagnose
