// Bodies that move as told: where they are, how they push and carry others, and that nothing is ever cut into.
#include "host/physics/energies/prescribed_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg::prescribed_motion_test {
namespace {

PathPoint at(double time, const Vec3& position, double yaw) {
  PathPoint point{time, Pose(Eigen::AngleAxisd(yaw, Vec3::UnitZ()))};
  point.pose.translation() = position;
  return point;
}

RigidBody moving_box(const std::string& name, const Vec3& half, const Vec3& position) {
  RigidBody body = box_body(name, half, 1000, position);
  body.is_prescribed = true;
  return body;
}

TEST(PrescribedMotion, RunsStraightBetweenThePointsOfItsPath) {
  RigidBody body;
  body.path = {at(0, Vec3::Zero(), 0), at(1, Vec3(2, 0, 0), 1), at(3, Vec3(2, 4, 0), 0)};
  EXPECT_TRUE(prescribed_pose(body, 0.25).isApprox(at(0, Vec3(0.5, 0, 0), 0.25).pose, 1e-12));
  EXPECT_TRUE(prescribed_pose(body, 2).isApprox(at(0, Vec3(2, 2, 0), 0.5).pose, 1e-12));
  EXPECT_TRUE(prescribed_pose(body, 9).isApprox(body.path.back().pose));
}

TEST(PrescribedMotion, OfConstantVelocitiesIsFollowedByTheSimulation) {
  Device device;
  PhysicalScene scene = empty_scene("turntable", 0.01);
  scene.rigid_bodies = {moving_box("plate", Vec3(0.1, 0.1, 0.01), Vec3::Zero())};
  scene.rigid_bodies[0].velocity = Vec3(0.5, 0, 0.1);
  scene.rigid_bodies[0].angular_velocity = Vec3(0, 0, 3);
  Simulation simulation(device, scene);
  for (int i = 0; i < 20; ++i) simulation.step(std::vector<double>{});
  const AffineMap& map = simulation.state().rigid[0];
  EXPECT_LE((map.col(3) - Vec3(0.1, 0, 0.02)).norm(), 1e-9);
  EXPECT_LE((map.leftCols<3>() - Eigen::AngleAxisd(0.6, Vec3::UnitZ()).toRotationMatrix()).norm(), 1e-9);
}

// A belt accelerates a box by friction: v grows by mu g h a step until it is the belt's.
TEST(PrescribedMotion, ABeltDragsABoxByFriction) {
  Device device;
  PhysicalScene scene = empty_scene("belt", 0.005);
  scene.contact.friction_lag_passes = -1;
  scene.rigid_bodies = {moving_box("belt", Vec3(1, 0.2, 0.02), Vec3(0, 0, -0.02)),
                        box_body("box", Vec3::Constant(0.05), 1000, Vec3(0, 0, 0.0506))};
  for (RigidBody& body : scene.rigid_bodies) body.friction = 0.3;
  Simulation simulation(device, scene);
  for (int i = 0; i < 40; ++i) simulation.step(std::vector<double>{});  // comes to rest on the belt
  scene.rigid_bodies[0].velocity = Vec3(0.4, 0, 0);
  scene.rigid_bodies[1].pose.translation() = simulation.state().rigid[1].col(3);
  Simulation moving(device, scene);
  double last = moving.state().rigid[1](0, 3), speed = 0;
  for (int i = 1; i <= 50; ++i) {
    moving.step(std::vector<double>{});
    const double x = moving.state().rigid[1](0, 3);
    speed = (x - last) / 0.005;
    last = x;
    if (i == 20) {
      EXPECT_NEAR(speed, 0.3 * 9.81 * 0.1, 0.02 * 0.3 * 9.81 * 0.1);
    }
  }
  EXPECT_NEAR(speed, 0.4, 1e-3);
}

// A wall pushes a box into a corner that does not yield: the wall stays behind its path, gaps stay open.
TEST(PrescribedMotion, NothingIsCutIntoWhereTheWayIsBlocked) {
  Device device;
  PhysicalScene scene = empty_scene("press", 0.01);
  scene.gravity = Vec3::Zero();
  scene.solver.velocity_tolerance = 1e-4;
  scene.rigid_bodies = {moving_box("wall", Vec3(0.02, 0.1, 0.1), Vec3(-0.1, 0, 0)),
                        box_body("box", Vec3::Constant(0.05), 1000, Vec3::Zero()),
                        fixed_box("stop", Vec3(0.02, 0.1, 0.1), Vec3(0.1, 0, 0))};
  scene.rigid_bodies[0].velocity = Vec3(0.5, 0, 0);
  Simulation simulation(device, scene);
  for (int i = 0; i < 12; ++i) {
    const StepReport report = simulation.step(std::vector<double>{});
    ASSERT_GT(report.min_gap, 0) << i;
  }
  // 60 mm of way for a gap of 60 mm: 30 mm on each side of the box at first; the rest of the way is not there
  const WorldState& state = simulation.state();
  EXPECT_LT(state.rigid[0](0, 3) + 0.02, state.rigid[1](0, 3) - 0.05);
  EXPECT_LT(state.rigid[1](0, 3) + 0.05, 0.08);
  EXPECT_GT(state.body_force[2].force.x(), 100);
}

TEST(HalfSpace, ABoxRestsOnAPlaneWithoutEndWithItsWeight) {
  Device device;
  PhysicalScene scene = empty_scene("plane", 0.01);
  RigidBody ground;
  ground.name = "ground";
  ground.is_fixed = ground.is_half_space = true;
  // 50 m away from the three points that define it
  scene.rigid_bodies = {ground, box_body("box", Vec3::Constant(0.05), 1000, Vec3(50, -30, 0.0506))};
  Simulation simulation(device, scene);
  for (int i = 0; i < 60; ++i) simulation.step(std::vector<double>{});
  const WorldState& state = simulation.state();
  EXPECT_NEAR(state.body_force[1].force.z(), 9.81, 1e-3 * 9.81);
  EXPECT_LE(state.body_force[1].torque.norm(), 1e-4);
  EXPECT_GT(state.rigid[1](2, 3), 0.05);
  for (const ContactForce& contact : state.contacts) EXPECT_EQ(contact.kind, ContactForce::Kind::point_plane);
}

// A box slides down a plane of tan 0.5 at mu 0.3 with a = g (sin - mu cos), from velocities after each step.
TEST(HalfSpace, ABoxSlidesDownASlopeWithItsFriction) {
  Device device;
  PhysicalScene scene = empty_scene("slope", 0.005);
  scene.contact.friction_lag_passes = -1;
  const double angle = std::atan(0.5);
  const Mat3 tilt = Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix();
  RigidBody ground;
  ground.name = "ground";
  ground.is_fixed = ground.is_half_space = true;
  ground.friction = 0.3;
  ground.pose.linear() = tilt;
  RigidBody box = box_body("box", Vec3(0.05, 0.05, 0.01), 1000, tilt * Vec3(0, 0, 0.0105));
  box.pose.linear() = tilt;
  box.friction = 0.3;
  scene.rigid_bodies = {ground, box};
  Simulation simulation(device, scene);
  std::vector<double> way;
  for (int i = 0; i <= 80; ++i) {
    way.push_back(Vec3(simulation.state().rigid[1].col(3)).dot(tilt * Vec3::UnitX()));
    simulation.step(std::vector<double>{});
  }
  const double acceleration = (way[80] - way[79] - way[60] + way[59]) / (0.005 * 20 * 0.005);
  const double expected = 9.81 * (std::sin(angle) - 0.3 * std::cos(angle));
  EXPECT_NEAR(acceleration, expected, 2e-3 * expected);
}

TEST(HalfSpace, IsNeverPassedHoweverFast) {
  Device device;
  PhysicalScene scene = empty_scene("shot", 0.02);
  scene.solver.velocity_tolerance = 1e-3;
  RigidBody ground;
  ground.name = "ground";
  ground.is_fixed = ground.is_half_space = true;
  scene.rigid_bodies = {ground, box_body("bullet", Vec3::Constant(0.005), 7800, Vec3(0, 0, 1))};
  scene.rigid_bodies[1].velocity = Vec3(3, 1, -300);
  scene.rigid_bodies[1].angular_velocity = Vec3(20, 50, 0);
  Simulation simulation(device, scene);
  for (int i = 0; i < 10; ++i) {
    ASSERT_GT(simulation.step(std::vector<double>{}).min_gap, 0);
    ASSERT_GT(simulation.state().rigid[1](2, 3), 0.0049);
  }
}

TEST(HalfSpace, ABodyBelowItIsRefusedByName) {
  Device device;
  PhysicalScene scene = empty_scene("buried", 0.01);
  RigidBody ground;
  ground.name = "ground";
  ground.is_fixed = ground.is_half_space = true;
  scene.rigid_bodies = {ground, box_body("box", Vec3::Constant(0.05), 1000, Vec3(0, 0, 0.03))};
  try {
    Simulation simulation(device, scene);
    FAIL() << "a box in the ground was accepted";
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find("ground"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("intersect"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace pvg::prescribed_motion_test
