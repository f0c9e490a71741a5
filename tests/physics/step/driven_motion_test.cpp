// Where drives lead a robot: exact turns about its joints, one iteration a step while its targets speed up, and nothing
// where contact holds it.
#include "host/physics/step/driven_motion.hpp"

#include <gtest/gtest.h>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

Joint driven(double stiffness) {
  Joint joint;
  joint.drive.mode = Drive::Mode::position;
  joint.drive.stiffness = stiffness;
  return joint;
}

std::vector<Carried> rod_of(const PhysicalScene& scene) { return carried_bodies(scene); }

TEST(DrivenMotion, ALinkTurnsAboutItsJointExactly) {
  const PhysicalScene scene = rod_on_hinge(0.3, driven(1e5));
  const System system = make_system(std::span(&scene, 1));
  std::vector<double> motion(system.x.size(), 0);
  const std::vector<double> by_velocity(system.x.size(), 0);
  const double change = 0.02;
  follow_drives(system, 0, std::vector<double>{change}, {}, system.x, by_velocity, motion);
  const Pose& pose = scene.rigid_bodies[1].pose;
  const Vec3 hinge(0, 0, 1);
  const Mat3 turn = Eigen::AngleAxisd(change, Vec3::UnitY()).toRotationMatrix();
  const double* rod = &motion[3 * system.rigid_first_node[0][1]];
  const Vec3 moved = turn * (pose.translation() - hinge) + hinge - pose.translation();
  EXPECT_LT((Eigen::Map<const Vec3>(rod) - moved).norm(), 1e-15);
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = pose.linear().col(k);
    EXPECT_LT((Eigen::Map<const Vec3>(rod + 3 * (k + 1)) - (turn * axis - axis)).norm(), 1e-15);
  }
  for (int k = 0; k < 12; ++k) EXPECT_EQ(motion[3 * system.rigid_first_node[0][0] + std::size_t(k)], 0) << "is fixed";
}

TEST(DrivenMotion, OnlyAJointThatFollowedItsTargetIsLed) {
  const PhysicalScene scene = rod_on_hinge(0.3, driven(1e5));
  const System system = make_system(std::span(&scene, 1));
  const auto changes = [&](double last, double last_target, double target) {
    const JointMotion motion = {0.3 - last, 0, 0, last_target};
    return foreseen_changes(system, 0, rod_of(scene), std::span(&motion, 1), std::vector<double>{0.3},
                            std::vector<double>{target}, {});
  };
  EXPECT_EQ(changes(0.010, 0.0101, 0.012), std::vector<double>{0.012});
  EXPECT_EQ(changes(0, 0, 0.001), std::vector<double>{0.001}) << "sets out";
  EXPECT_FALSE(changes(0, 0.010, 0.010)) << "is blocked";
  EXPECT_FALSE(changes(0.010, 0.010, 0.010)) << "goes on as it did";
}

TEST(DrivenMotion, AJointIsNotLedWhereContactHoldsWhatItCarries) {
  PhysicalScene scene = rod_on_hinge(0.3, driven(1e5));
  scene.rigid_bodies.push_back(box_body("held", Vec3::Constant(0.01), 1000, Vec3(1, 0, 0)));
  scene.rigid_bodies.push_back(fixed_box("wall", Vec3::Constant(0.1), Vec3(2, 0, 0)));
  const System system = make_system(std::span(&scene, 1));
  const auto is_led = [&](std::vector<std::array<u32, 2>> pairs) {
    std::vector<Friction> contacts;
    for (const auto& [a, b] : pairs) {
      Friction& contact = contacts.emplace_back();
      contact.body[0] = a, contact.body[1] = b;
      contact.normal_force = 1;
    }
    const JointMotion motion = {0.3, 0, 0, 0};
    return foreseen_changes(system, 0, rod_of(scene), std::span(&motion, 1), std::vector<double>{0.3},
                            std::vector<double>{0.001}, contacts)
        .has_value();
  };
  EXPECT_TRUE(is_led({}));
  EXPECT_TRUE(is_led({{1, 2}})) << "what touches the rod alone goes along";
  EXPECT_TRUE(is_led({{2, 3}}));
  EXPECT_FALSE(is_led({{1, 3}}));
  EXPECT_FALSE(is_led({{1, 2}, {2, 3}})) << "what also touches the wall does not";
}

TEST(DrivenMotion, AFreeBodyIsMovedAsWhatItTouches) {
  PhysicalScene scene = rod_on_hinge(0, driven(1e5));
  scene.rigid_bodies.push_back(box_body("held", Vec3::Constant(0.01), 1000, Vec3(0.05, 0, 0.7)));
  const System system = make_system(std::span(&scene, 1));
  Friction contact{};
  contact.body[0] = 1, contact.body[1] = 2;
  contact.normal_force = 2;
  std::vector<double> motion(system.x.size(), 0);
  const std::vector<double> by_velocity(system.x.size(), 0);
  follow_drives(system, 0, std::vector<double>{0.02}, std::span(&contact, 1), system.x, by_velocity, motion);
  const Vec3 from_hinge = Vec3(0.05, 0, 0.7) - Vec3(0, 0, 1);
  const Vec3 moved = Eigen::AngleAxisd(0.02, Vec3::UnitY()) * from_hinge - from_hinge;
  EXPECT_LT((Eigen::Map<const Vec3>(&motion[3 * system.rigid_first_node[0][2]]) - moved).norm(), 1e-15);
}

// A cubic target speeds up ever more, which velocities do not foretell.
TEST(DrivenMotion, ARobotWhoseTargetsSpeedUpTakesOneIterationAStep) {
  PhysicalScene scene = rod_on_hinge(0, driven(1e5));
  scene.solver.velocity_tolerance = 1e-3;
  scene.solver.time_step = 0.02;
  scene.joints[0].drive.compensates_gravity = true;
  Device device;
  Simulation simulation(device, scene);
  int newton = 0;
  const auto target = [](int step) { return 2.0 * std::pow(0.02 * step, 3); };
  for (int i = 1; i <= 30; ++i) {
    const int taken = simulation.step({target(i)}).newton;
    if (i > 10) newton += taken;
  }
  EXPECT_EQ(newton, 20);
  EXPECT_NEAR(simulation.state().joint_position[0], target(30), 1e-4);
}

}  // namespace
}  // namespace pvg
