// The noise of channels that share a recording with others, or with a motion that is as fast as noise
#include "host/identify/data/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace pvg::diagnose {
namespace {

TEST(OwnSamples, AreThoseOfTheChannelsOwnRateWithItsDropouts) {
  const double none = std::nan("");
  // every second row, the third sample of them is missing
  const std::vector<double> own =
      own_samples({0, 1, 2, 3, 4, 5, 6, 7, 8}, {0, none, 2, none, none, none, 6, none, 8}, 1);
  ASSERT_EQ(own.size(), 5u);
  EXPECT_EQ(own[1], 2);
  EXPECT_TRUE(std::isnan(own[2]));
  EXPECT_EQ(own[3], 6);
}

TEST(OwnSamples, OfAFullTableAreItsRows) {
  const std::vector<double> values = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(own_samples({0, 0.011, 0.019, 0.03}, values, 2), values);
}

// An angle of seven turns: its noise is a thirty thousandth of its range, and is seen. What shows no noise, or only its
// digits, has the least one.
TEST(Noise, OfAWideRangeIsWhatIsSeenOfIt) {
  const auto measured = [](double sigma, double digit) {
    std::mt19937 engine(1);
    std::normal_distribution<double> noise(0, 1);
    Problem problem;
    problem.channels.resize(1);
    diagnose::Run run;
    run.noise_scale = {1};
    run.values.emplace_back();
    for (int i = 0; i <= 480; ++i) {
      const double t = 0.005 * i, q = 22 * (1 - std::cos(std::numbers::pi * t / 2.4)) + sigma * noise(engine);
      run.t.push_back(t);
      run.values[0].push_back(digit > 0 ? digit * std::round(q / digit) : q);
    }
    problem.runs.push_back(std::move(run));
    measure_noise(problem);
    return problem.channels[0].sigma;
  };
  EXPECT_NEAR(measured(1.3e-3, 0), 1.3e-3, 2e-4);
  EXPECT_NEAR(measured(1.3e-3, 1e-5), 1.3e-3, 2e-4);
  EXPECT_NEAR(measured(0, 0), 4.4e-3, 1e-5);
  EXPECT_NEAR(measured(0, 1e-2), 4.4e-3, 1e-5);
}

struct Motion {
  double noise = 0, chatter = 0;  // sigma, amplitude
};

// A slow motion at 100 Hz, with chatter of 29 Hz that is the same whenever the motion is.
diagnose::Run run_of(const Motion& motion, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0, motion.noise);
  diagnose::Run run;
  run.noise_scale = {1};
  run.values.emplace_back();
  run.targets = {{{0, 20}, {0, 1}}};
  for (int i = 0; i < 2000; ++i) {
    run.t.push_back(0.01 * i);
    run.values[0].push_back(std::sin(0.01 * i) + motion.chatter * std::sin(2 * std::numbers::pi * 0.29 * i) +
                            noise(engine));
  }
  return run;
}

Problem problem_of(std::vector<diagnose::Run> runs) {
  Problem problem;
  problem.channels.resize(1);
  problem.runs = std::move(runs);
  measure_noise(problem);
  return problem;
}

// Three commands, so nothing is repeated: chatter of 12 mrad beside noise of 0.5 mrad could be noise that a sensor
// has smoothed, and the channel says so.
TEST(Noise, ThatMayBeChatterIsSaidToBeUnsure) {
  std::vector<diagnose::Run> runs = {run_of({5e-4, 0.012}, 1), run_of({5e-4, 0.012}, 2)};
  runs[1].targets[0].value[1] = 2;
  const Problem problem = problem_of(std::move(runs));
  EXPECT_GT(problem.channels[0].sigma, 4e-3);
  EXPECT_GT(problem.channels[0].least_sigma, 4e-4);
  EXPECT_LT(problem.channels[0].least_sigma, 1e-3);
}

// What two runs of one command share is no noise, and what they do not share is all of it.
TEST(Noise, IsWhatTwoRunsOfOneCommandDoNotShare) {
  const Problem problem = problem_of({run_of({5e-4, 0.012}, 1), run_of({5e-4, 0.012}, 2)});
  EXPECT_NEAR(problem.channels[0].sigma, 5e-4, 5e-5);
  EXPECT_EQ(problem.channels[0].least_sigma, 0);
  EXPECT_EQ(problem.runs[0].noise_scale[0], 1);
}

TEST(Noise, ThatIsWhiteIsSure) {
  const Problem problem = problem_of({run_of({5e-4, 0}, 1)});
  EXPECT_NEAR(problem.channels[0].sigma, 5e-4, 5e-5);
  EXPECT_EQ(problem.channels[0].least_sigma, 0);
}

// 10 Hz beside rows of 100 Hz: of noise of 2 mm the differences of neighbouring samples of the channel itself.
TEST(Noise, OfASlowChannelIsMeasuredOverItsOwnSamples) {
  diagnose::Run run = run_of({2e-3, 0}, 3);
  for (std::size_t i = 0; i < run.t.size(); ++i)
    if (i % 10 != 0) run.values[0][i] = std::nan("");
  const Problem problem = problem_of({run});
  EXPECT_FALSE(problem.channels[0].is_noise_assumed);
  EXPECT_NEAR(problem.channels[0].sigma, 2e-3, 4e-4);
}

// Six samples of 0 to 1 tell no noise: 0.01 is assumed. An error of half of that may be ten times the true noise.
TEST(Noise, ThatIsAssumedMayBeAnyLess) {
  diagnose::Run run;
  run.noise_scale = {1};
  run.t = {0, 1, 2, 3, 4, 5};
  run.values = {{0, 0.1, 0.4, 0.9, 1, 0.8}};
  Problem problem = problem_of({run});
  EXPECT_TRUE(problem.channels[0].is_noise_assumed);
  EXPECT_DOUBLE_EQ(problem.channels[0].sigma, 0.01);
  const std::string supposed = suppose_less_noise(problem, 0.5);
  EXPECT_DOUBLE_EQ(problem.channels[0].sigma, 0.0005);
  EXPECT_NE(supposed.find("is unknown: with 0.01"), std::string::npos) << supposed;
  problem.channels[0].least_sigma = 0;
  EXPECT_EQ(suppose_less_noise(problem, 0.5), "");
}

}  // namespace
}  // namespace pvg::diagnose
