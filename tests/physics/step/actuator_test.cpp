// Targets delayed and followed with a lag
#include "host/physics/step/actuator.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

PhysicalScene driven(double delay, double time_constant) {
  PhysicalScene scene;
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

// the answer to a ramp from rest is t - T (1 - exp(-t / T)), however short T is beside the step
TEST(Actuators, FollowARampExactly) {
  for (const double time_constant : {0.04, 0.001}) {
    Actuators actuators(driven(0, time_constant), {0});
    const std::vector<double> found = commands(actuators, {0.01, 0.02, 0.03, 0.04, 0.05, 0.06});
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double t = 0.01 * double(i + 1);
      EXPECT_NEAR(found[i], t - time_constant * (1 - std::exp(-t / time_constant)), 1e-15);
    }
  }
}

// the same 25 ms later; before that nothing
TEST(Actuators, FollowADelayedRampExactly) {
  Actuators actuators(driven(0.025, 0.04), {0});
  const std::vector<double> found = commands(actuators, {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08});
  EXPECT_EQ(found[1], 0);
  // targets are straight between steps, so what is delayed by half a step starts its ramp in the middle of one: it
  // rises by 5 mrad in the third step and by 10 in each further one
  const auto ramp = [](double t) { return t > 0 ? t - 0.04 * (1 - std::exp(-t / 0.04)) : 0; };
  for (std::size_t i = 2; i < found.size(); ++i) {
    const double t = 0.01 * double(i + 1);
    EXPECT_NEAR(found[i], 0.5 * ramp(t - 0.02) + 0.5 * ramp(t - 0.03), 1e-15) << i;
  }
}

TEST(Actuators, GoOnFromTheirPast) {
  Actuators one(driven(0.035, 0), {0}), other(driven(0.035, 0), {0});
  commands(one, {1, 2, 3, 4});
  ASSERT_TRUE(other.restore(one.past()));
  EXPECT_EQ(one.command({5}, {0}), other.command({5}, {0}));
  EXPECT_FALSE(other.restore({1}));
  Actuators lags(driven(0, 0.04), {0}), goes_on(driven(0, 0.04), {0});
  const double last = commands(lags, {1, 2, 3}).back();
  ASSERT_TRUE(goes_on.restore(lags.past()));
  EXPECT_EQ(lags.command({5}, {last}), goes_on.command({5}, {last}));
}

}  // namespace
}  // namespace pvg
