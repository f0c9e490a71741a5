// What drives still obey where a window begins
#include "host/identify/sensing/world.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg::diagnose {
namespace {

// commanded along a ramp of 1 rad/s from 0 on
Run ramp() {
  Run run;
  run.t = {0, 1};
  run.targets = {TargetTable{{0, 1}, {0, 1}}};
  return run;
}

Scene driven(const Effect& effect) {
  Scene scene;
  scene.solver.time_step = 0.01;
  Joint joint;
  joint.name = "shoulder";
  joint.type = Joint::Type::revolute;
  joint.drive.stiffness = 1;
  scene.joints = {joint};
  scene.effects = {effect};
  return scene;
}

TEST(World, ALateDriveKnowsTheCommandsBeforeItsWindow) {
  const DriveMemory lags = memory_of(driven({"actuator_lag", "shoulder", {0.04}}), ramp(), 0.3, 0.01);
  EXPECT_NEAR(lags.command[0], 0.3 - 0.04 * (1 - std::exp(-0.3 / 0.04)), 1e-12);
  const DriveMemory delays = memory_of(driven({"actuator_delay", "shoulder", {0.025}}), ramp(), 0.3, 0.01);
  EXPECT_NEAR(delays.command[0], 0.275, 1e-12);
  ASSERT_EQ(delays.past.size(), 3u);
  for (int ago = 0; ago < 3; ++ago) EXPECT_NEAR(delays.past[std::size_t(ago)], 0.3 - 0.01 * ago, 1e-12);
}

TEST(World, BeforeARunItsFirstCommandWasHeld) {
  const DriveMemory lags = memory_of(driven({"actuator_lag", "shoulder", {0.04}}), ramp(), 0, 0.01);
  EXPECT_EQ(lags.command[0], 0);
}

}  // namespace
}  // namespace pvg::diagnose
