// The next experiment: what counts as a separation, and which motions there are.
#include "host/identify/search/next_experiment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace pvg::diagnose {
namespace {

// A difference of 10 along a column that a parameter of prior 1 moves by 10 per deviation: it makes up for
// 10 - 10 / (1 + 100), at the price of its prior.
TEST(NextExperiment, WhatAParameterMakesUpForSeparatesNothing) {
  Eigen::VectorXd difference(2);
  difference << 10, 4;
  Eigen::MatrixXd column(2, 1);
  column << 10, 0;
  EXPECT_NEAR(separation_of(difference, column), std::hypot(10.0 / 101, 4), 1e-9);
  EXPECT_NEAR(separation_of(difference, Eigen::MatrixXd(2, 0)), std::hypot(10, 4), 1e-12);
}

// A drive that was told to go from 0 to 0.4 and back.
Problem driven() {
  Problem problem;
  problem.scene.scene.joints.resize(1);
  Joint& joint = problem.scene.scene.joints[0];
  joint.name = "shoulder";
  joint.type = Joint::Type::revolute;
  joint.drive.stiffness = 20;
  joint.parent = 0, joint.child = 1;
  problem.scene.scene.rigid_bodies.resize(2);
  problem.coordinates = {0};
  problem.can_restart = true;
  problem.channels.resize(1);
  problem.channels[0].joint = 0;
  problem.channels[0].sigma = 1e-3;
  diagnose::Run run;
  for (int i = 0; i < 100; ++i) run.t.push_back(0.02 * i);
  run.values = {std::vector<double>(100, 0.0)};
  run.noise_scale = {1};
  run.targets = {{{0, 1, 1.98}, {0, 0.4, 0}}};
  problem.runs = {run};
  problem.recording.runs.resize(1);
  return problem;
}

TEST(NextExperiment, CommandsStayWithinOneAndAHalfTimesWhatWasRecorded) {
  const Problem problem = driven();
  const std::vector<PlannedMotion> motions = motion_family(problem);
  EXPECT_EQ(motions.size(), 4u * 3 * 3);
  std::set<std::string> descriptions;
  double most = 0;
  for (const PlannedMotion& motion : motions) {
    descriptions.insert(motion.description);
    EXPECT_EQ(motion.targets.at(0).value.front(), 0) << "begins where the recorded commands did";
    for (const double value : motion.targets[0].value) most = std::max(most, std::abs(value));
  }
  EXPECT_EQ(descriptions.size(), motions.size());
  EXPECT_NEAR(most, 0.6, 1e-3);
  const Problem planned = planned_problem(problem, motions);
  EXPECT_EQ(planned.runs.size(), motions.size());
  EXPECT_EQ(planned.runs[0].t.size(), 100u);
}

}  // namespace
}  // namespace pvg::diagnose
