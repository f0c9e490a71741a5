// Joints in the simulator: stops hold, drives follow their modes, against recurrences and balances by hand.
#include "host/physics/energies/joint.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

constexpr double ROD_MASS = 0.16, ROD_CENTRE = 0.2;  // [kg], [m] from the hinge
constexpr double ROD_INERTIA = ROD_MASS * ((0.16 + 0.0004) / 12 + ROD_CENTRE * ROD_CENTRE);

double weight_torque(double q) { return ROD_MASS * 9.81 * ROD_CENTRE * std::sin(q); }

Joint with_limits(double lower, double upper) {
  Joint joint;
  joint.lower = lower;
  joint.upper = upper;
  return joint;
}

Joint with_drive(Drive::Mode mode, double stiffness, double damping, double effort_limit) {
  Joint joint;
  joint.drive = {mode, stiffness, damping, effort_limit, false};
  return joint;
}

TEST(JointLimit, APendulumStopsAtItsLimitAndLeansOnIt) {
  Device device;
  Simulation simulation(device, rod_on_hinge(0.5, with_limits(0.2, 1)));
  double lowest = 1;
  for (int i = 0; i < 200; ++i) {
    simulation.step(std::vector<double>{});
    lowest = std::min(lowest, simulation.state().joint_position[0]);
  }
  EXPECT_GE(lowest, 0.2 - 0.01 * 0.8);
  const double q = simulation.state().joint_position[0];
  EXPECT_NEAR(simulation.state().joint_stop_effort[0], weight_torque(q), 1e-3 * weight_torque(q));
  EXPECT_NEAR(0.2 - q, weight_torque(q) / 1e5, 1e-3 * weight_torque(q) / 1e5);
}

TEST(JointLimit, AFallingSliderStopsAtItsLimitWithItsWeight) {
  Device device;
  Simulation simulation(device, box_on_rail(with_limits(-0.05, 0.05)));
  double lowest = 1;
  for (int i = 0; i < 60; ++i) {
    simulation.step(std::vector<double>{});
    lowest = std::min(lowest, simulation.state().joint_position[0]);
  }
  EXPECT_GE(lowest, -0.05 - 0.01 * 0.1);
  EXPECT_NEAR(simulation.state().joint_stop_effort[0], 9.81, 1e-3 * 9.81);
}

TEST(JointLimit, ActsOnJointsThatAreDrivenToo) {
  Device device;
  Joint joint = with_drive(Drive::Mode::position, 100, 5, 0);
  joint.lower = -0.3;
  joint.upper = 0.3;
  Simulation simulation(device, rod_on_hinge(0, joint));
  for (int i = 0; i < 100; ++i) simulation.step(std::vector<double>{0.8});
  const WorldState& state = simulation.state();
  EXPECT_NEAR(state.joint_position[0], 0.3, 1e-3);
  // drive, stop and weight are in balance
  EXPECT_NEAR(state.joint_effort[0] + state.joint_stop_effort[0], weight_torque(state.joint_position[0]), 1e-3);
  EXPECT_NEAR(state.joint_effort[0], 50, 0.1);
}

TEST(Drive, CannotExceedItsEffortLimit) {
  Device device;
  const PhysicalScene scene = rod_on_hinge(0.5, with_drive(Drive::Mode::position, 1000, 10, 0.05));
  Simulation simulation(device, scene);
  simulation.step(std::vector<double>{0.5});
  // from rest, the part of the weight that is too much for the drive accelerates the rod
  const double q = simulation.state().joint_position[0], h = scene.solver.time_step;
  simulation.step(std::vector<double>{2.0});
  EXPECT_NEAR(simulation.state().joint_effort[0], 0.05, 1e-12);
  const double after = simulation.state().joint_position[0];
  const double acceleration = (after - 2 * q + 0.5) / (h * h);
  EXPECT_NEAR(acceleration, (0.05 - weight_torque(after)) / ROD_INERTIA, 0.01);
}

TEST(Drive, OfAVelocityFollowsItsRecurrenceAndItsLimit) {
  Device device;
  for (const double limit : {0.0, 5.0}) {
    PhysicalScene scene = box_on_rail(with_drive(Drive::Mode::velocity, 0, 100, limit));
    scene.gravity = Vec3::Zero();
    Simulation simulation(device, scene);
    const double h = 0.01, mass = 1;
    double v = 0, q = 0;
    for (int i = 0; i < 20; ++i) {
      simulation.step(std::vector<double>{0.3});
      // m (v' - v) / h = cut(c (v_target - v'))
      double next = (mass * v + h * 100 * 0.3) / (mass + h * 100);
      double effort = 100 * (0.3 - next);
      if (limit > 0 && effort > limit) {
        effort = limit;
        next = v + h * limit / mass;
      }
      v = next;
      q += h * v;
      ASSERT_NEAR(simulation.state().joint_position[0], q, 1e-8) << i;
      ASSERT_NEAR(simulation.state().joint_effort[0], effort, 1e-4) << i;
    }
    EXPECT_NEAR(v, 0.3, 1e-3);
  }
}

TEST(Drive, OfATorqueAcceleratesByForceOverMassAndIsCut) {
  Device device;
  for (const double limit : {0.0, 1.5}) {
    PhysicalScene scene = box_on_rail(with_drive(Drive::Mode::torque, 0, 0, limit));
    scene.gravity = Vec3::Zero();
    Simulation simulation(device, scene);
    const int n = 20;
    const double force = limit > 0 ? limit : 2;
    for (int i = 0; i < n; ++i) simulation.step(std::vector<double>{2.0});
    // q_n = F/m h^2 n (n + 1) / 2
    EXPECT_NEAR(simulation.state().joint_position[0], force * 1e-4 * n * (n + 1) / 2, 1e-8);
    EXPECT_EQ(simulation.state().joint_effort[0], force);
  }
}

TEST(Drive, ATorqueThatCompensatesGravityAddsToIt) {
  Device device;
  Joint joint = with_drive(Drive::Mode::torque, 0, 0, 0);
  joint.drive.compensates_gravity = true;
  Simulation simulation(device, box_on_rail(joint));
  for (int i = 0; i < 10; ++i) simulation.step(std::vector<double>{0.0});
  EXPECT_NEAR(simulation.state().joint_position[0], 0, 1e-8);
  EXPECT_NEAR(simulation.state().joint_effort[0], 9.81, 1e-9);
}

TEST(Joint, DampingSlowsItsCoordinateByTheRecurrence) {
  Device device;
  Joint joint;
  joint.damping = 20;
  PhysicalScene scene = box_on_rail(joint);
  scene.gravity = Vec3::Zero();
  scene.rigid_bodies[1].velocity = Vec3(0, 0, 0.5);
  Simulation simulation(device, scene);
  double v = 0.5, q = 0;
  for (int i = 0; i < 20; ++i) {
    simulation.step(std::vector<double>{});
    v = v / (1 + 0.01 * 20);
    q += 0.01 * v;
    ASSERT_NEAR(simulation.state().joint_position[0], q, 1e-8);
    ASSERT_NEAR(simulation.state().joint_damping_effort[0], -20 * v, 1e-4);
  }
}

}  // namespace
}  // namespace pvg
