// Targets delayed and followed with a lag
#include "host/physics/actuator.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

Scene driven(double delay, double time_constant) {
  Scene scene;
  scene.solver.time_step = 0.01;
  Joint joint;
  joint.type = Joint::Type::revolute;
  joint.drive.stiffness = 1;
  joint.drive.delay = delay;
  joint.drive.time_constant = time_constant;
  scene.joints = {joint};
  return scene;
}

std::vector<double> commands(Actuators& actuators, const std::vector<double>& given) {
  std::vector<double> all, last = {0};
  for (const double target : given) {
    last = actuators.command({target}, last);
    actuators.accept({target});
    all.push_back(last[0]);
  }
  return all;
}

// a ramp of 1 rad/s, 25 ms later: 0.025 rad behind once the delay has passed
TEST(Actuators, DelayARampByTwoStepsAndAHalf) {
  Actuators actuators(driven(0.025, 0), {0});
  const std::vector<double> found = commands(actuators, {0.01, 0.02, 0.03, 0.04, 0.05});
  const std::vector<double> expected = {0, 0, 0.005, 0.015, 0.025};
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-15) << i;
}

// a step is followed as 1 - exp(-t / T), whatever the step length
TEST(Actuators, FollowAStepExponentially) {
  Actuators actuators(driven(0, 0.04), {0});
  const std::vector<double> found = commands(actuators, std::vector<double>(8, 1.0));
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], 1 - std::exp(-0.01 * double(i + 1) / 0.04), 1e-14);
}

TEST(Actuators, GoOnFromTheirPast) {
  Actuators one(driven(0.035, 0), {0}), other(driven(0.035, 0), {0});
  commands(one, {1, 2, 3, 4});
  ASSERT_TRUE(other.restore(one.past()));
  EXPECT_EQ(one.command({5}, {0}), other.command({5}, {0}));
  EXPECT_FALSE(other.restore({1}));
}

}  // namespace
}  // namespace pvg
