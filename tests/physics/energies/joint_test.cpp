// Joints in the simulator: stops hold, drives follow their modes, against recurrences and balances by hand.
#include "host/physics/energies/joint.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg::joint_test {
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
  joint.drive = {mode, stiffness, damping, Drive::DampedRate::error, effort_limit, false};
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

// 1 kg behind a target that moves at 0.1 m/s, 1000 N/m and 100 N s/m: damping of the error lets it catch up, damping of
// the joint alone leaves it c v / k = 10 mm behind
TEST(Drive, DampsTheRateThatItIsToldTo) {
  Device device;
  for (const Drive::DampedRate rate : {Drive::DampedRate::error, Drive::DampedRate::joint}) {
    Joint joint = with_drive(Drive::Mode::position, 1000, 100, 0);
    joint.drive.damped_rate = rate;
    PhysicalScene scene = box_on_rail(joint);
    scene.gravity = Vec3::Zero();
    Simulation simulation(device, scene);
    double target = 0;
    for (int i = 1; i <= 200; ++i) simulation.step(std::vector<double>{target = 0.001 * i});
    EXPECT_NEAR(target - simulation.state().joint_position[0], rate == Drive::DampedRate::error ? 0 : 0.01, 1e-6);
  }
}

// A dead band of 20 mm hangs lower by half of it: 10 mm + 9.81 N / (1000 N/m)
TEST(Drive, HangsLowerByHalfItsDeadBand) {
  Device device;
  Joint joint = with_drive(Drive::Mode::position, 1000, 60, 0);
  joint.drive.play = 0.02;
  Simulation simulation(device, box_on_rail(joint));
  for (int i = 0; i < 150; ++i) simulation.step(std::vector<double>{0.0});
  EXPECT_NEAR(simulation.state().joint_position[0], -0.01981, 1e-5);
  EXPECT_NEAR(simulation.state().joint_effort[0], 9.81, 1e-2);
}

// Its damping is within the limit, with a dead band as without: a fast box is braked by 5 N, not by 100 N s/m x 0.5 m/s
TEST(Drive, ItsDampingIsCutToo) {
  Device device;
  for (const double play : {0.0, 0.02}) {
    Joint joint = with_drive(Drive::Mode::position, 10, 100, 5);
    joint.drive.play = play;
    PhysicalScene scene = box_on_rail(joint);
    scene.gravity = Vec3::Zero();
    scene.rigid_bodies[1].velocity = Vec3(0, 0, 0.5);
    Simulation simulation(device, scene);
    for (int i = 1; i <= 5; ++i) {
      simulation.step(std::vector<double>{0.0});
      EXPECT_NEAR(simulation.state().joint_effort[0], -5, 1e-9);
    }
    // q_n = n h v - F/m h^2 n (n + 1) / 2
    EXPECT_NEAR(simulation.state().joint_position[0], 5 * 0.01 * 0.5 - 5 * 1e-4 * 15, 1e-8);
  }
}

TEST(Joint, ArmatureAddsToTheMassByTheRecurrence) {
  Device device;
  for (const auto integrator : {SolverSettings::Integrator::implicit_euler, SolverSettings::Integrator::bdf2}) {
    Joint joint = with_drive(Drive::Mode::torque, 0, 0, 0);
    joint.armature = 3;
    PhysicalScene scene = box_on_rail(joint);
    scene.gravity = Vec3::Zero();
    scene.rigid_bodies[1].velocity = Vec3(0, 0, 0.2);
    scene.solver.integrator = integrator;
    Simulation simulation(device, scene);
    const double h = 0.01, acceleration = 2.0 / (1 + 3);
    double q = 0, v = 0.2, q_before = 0, v_before = 0;
    for (int i = 0; i < 20; ++i) {
      simulation.step(std::vector<double>{2.0});
      const bool is_second = integrator == SolverSettings::Integrator::bdf2 && i > 0;
      const double length = is_second ? 2 * h / 3 : h, past = is_second ? (4 * q - q_before) / 3 : q;
      const double rate = (is_second ? (4 * v - v_before) / 3 : v) + length * acceleration;
      q_before = q;
      v_before = v;
      q = past + length * rate;
      v = rate;
      ASSERT_NEAR(simulation.state().joint_position[0], q, 1e-8) << i;
    }
  }
}

// T = 2 pi sqrt((I + J) / (m g l)): a rotor as heavy to turn as the rod makes its swing sqrt(2) times longer
TEST(Joint, ArmatureLengthensThePeriodOfAPendulum) {
  Device device;
  Joint joint;
  joint.armature = ROD_INERTIA;
  PhysicalScene scene = rod_on_hinge(0.05, joint);
  scene.solver.integrator = SolverSettings::Integrator::bdf2;
  Simulation simulation(device, scene);
  const double quarter = M_PI / 2 * std::sqrt(2 * ROD_INERTIA / (ROD_MASS * 9.81 * ROD_CENTRE));
  double last = 0.05, crossing = 0;
  for (int i = 1; crossing == 0 && i < 200; ++i) {
    simulation.step(std::vector<double>{});
    const double q = simulation.state().joint_position[0];
    if (last > 0 && q <= 0) crossing = 0.005 * (i - 1 + last / (last - q));
    last = q;
  }
  EXPECT_NEAR(crossing, quarter, 0.005 * quarter);
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
}  // namespace pvg::joint_test
