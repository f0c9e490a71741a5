// Closing until a force is felt, on a plan and on states made by hand.
#include "pipeline/episode/force_grasp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

// one gripper of two joints behind one arm joint: closes from 40 to 10 mm in 10 steps, waits 2, opens to 40 in 10
MotionPlan plan_with(double force) {
  MotionPlan plan;
  for (int k = 1; k <= 22; ++k) {
    const double close = std::min(k, 10) / 10.0, open = std::max(k - 12, 0) / 10.0;
    const double gripper = 0.04 - 0.03 * close + 0.03 * open;
    plan.targets.push_back({0.1 * k, gripper, gripper});
  }
  plan.grips = {{0, 0, 10, 0.04, 0.01, force}, {0, 12, 22, 0.01, 0.04, 0}};
  plan.gripper_columns = {{1, 2}};
  plan.gripper_joints = {{4, 5}};
  return plan;
}

WorldState feeling(double force) {
  WorldState state;
  state.joint_effort = {0, 0, 0, 0, -force, -force};  // toward closing is negative
  return state;
}

TEST(ForceGrasp, WithoutAForceThePlanIsKept) {
  const MotionPlan plan = plan_with(0);
  ForceGrasp grasp(plan);
  for (std::size_t k = 0; k < plan.targets.size(); ++k) {
    const std::vector<double> target = grasp.target(k, feeling(100));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(target[i], plan.targets[k][i], 1e-15) << k;
  }
}

TEST(ForceGrasp, StopsWhereTheForceIsFeltAndOpensFromThere) {
  const MotionPlan plan = plan_with(5);
  ForceGrasp grasp(plan);
  std::vector<double> gripper;
  for (std::size_t k = 0; k < plan.targets.size(); ++k) {
    const std::vector<double> target = grasp.target(k, feeling(k >= 6 ? 5.1 : 4.9));
    EXPECT_EQ(target[0], plan.targets[k][0]);  // the arm goes on
    EXPECT_EQ(target[1], target[2]);
    gripper.push_back(target[1]);
  }
  EXPECT_NEAR(gripper[5], 0.04 - 0.03 * 0.6, 1e-15);
  // it had 3 mm per step, and comes to rest within half of that, and half of that ...
  EXPECT_NEAR(gripper[6], gripper[5] - 0.0015, 1e-15);
  EXPECT_GT(gripper[9], gripper[5] - 0.003);
  EXPECT_EQ(gripper[11], gripper[9]);
  EXPECT_NEAR(gripper[12], gripper[11] + 0.1 * (0.04 - gripper[11]), 1e-12);
  EXPECT_NEAR(gripper[21], 0.04, 1e-12);
}

}  // namespace
}  // namespace pvg
