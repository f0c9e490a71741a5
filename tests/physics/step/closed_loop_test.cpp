// A closed loop of joints: a planar four-bar linkage against its closed form.
// Ground d along x from the crank's hinge O to the rocker's hinge C, crank a at the angle t, coupler b, rocker c at the
// angle r, both angles from x: with A = a (cos t, sin t), the rocker's end B is where circles about A and C meet.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

constexpr double A = 0.1, B = 0.25, C = 0.2, D = 0.3;  // crank, coupler, rocker, ground [m]

struct Linkage {
  Eigen::Vector2d crank_end, rocker_end;
};

Linkage closed_form(double t) {
  const Eigen::Vector2d a(A * std::cos(t), A * std::sin(t)), c(D, 0), to = c - a;
  const double along = (to.squaredNorm() + B * B - C * C) / (2 * to.norm());
  const double across = std::sqrt(B * B - along * along);
  const Eigen::Vector2d unit = to.normalized();
  return {a, a + along * unit + across * Eigen::Vector2d(-unit.y(), unit.x())};
}

double angle(const Eigen::Vector2d& v) { return std::atan2(v.y(), v.x()); }

// a bar in the plane z = 0 whose frame lies at `from`, x towards `to`
RigidBody bar(const std::string& name, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  RigidBody body = box_body(name, Vec3((to - from).norm() / 2, 0.005, 0.005), 1000, Vec3(from.x(), from.y(), 0));
  body.center_of_mass.x() = (to - from).norm() / 2;
  body.pose.linear() = Eigen::AngleAxisd(angle(to - from), Vec3::UnitZ()).toRotationMatrix();
  body.collision = {};
  return body;
}

Joint hinge(const PhysicalScene& scene, int parent, int child, const Eigen::Vector2d& at) {
  Joint joint;
  joint.name = "hinge" + std::to_string(scene.joints.size());
  joint.type = Joint::Type::revolute;
  joint.parent = parent;
  joint.child = child;
  Pose frame = Pose::Identity();
  frame.translation() = Vec3(at.x(), at.y(), 0);
  joint.parent_frame = scene.rigid_bodies[parent].pose.inverse() * frame;
  joint.child_frame = scene.rigid_bodies[child].pose.inverse() * frame;
  return joint;
}

PhysicalScene four_bar(double start) {
  const Linkage at = closed_form(start);
  const Eigen::Vector2d origin(0, 0), ground(D, 0);
  PhysicalScene scene = empty_scene("four-bar", 0.01);
  scene.gravity = Vec3::Zero();
  scene.solver.velocity_tolerance = 1e-9;
  scene.rigid_bodies = {fixed_box("ground", Vec3::Constant(0.01), Vec3::Zero()), bar("crank", origin, at.crank_end),
                        bar("coupler", at.crank_end, at.rocker_end), bar("rocker", ground, at.rocker_end)};
  scene.joints.push_back(hinge(scene, 0, 1, origin));
  scene.joints.push_back(hinge(scene, 1, 2, at.crank_end));
  scene.joints.push_back(hinge(scene, 2, 3, at.rocker_end));
  scene.joints.push_back(hinge(scene, 0, 3, ground));
  scene.joints[0].drive.stiffness = 1e3;
  scene.joints[0].drive.damping = 10;
  scene.joints[0].drive.compensates_gravity = false;
  return scene;
}

TEST(ClosedLoop, AFourBarLinkageFollowsItsClosedForm) {
  Device device;
  const double start = 1.0;
  Simulation simulation(device, four_bar(start));
  const double rocker_start = angle(closed_form(start).rocker_end - Eigen::Vector2d(D, 0));
  // the crank turns by 0.5 rad and rests there
  for (int i = 1; i <= 120; ++i) simulation.step(std::vector<double>{std::min(0.5, 0.01 * i)});
  const WorldState& state = simulation.state();
  const double t = start + state.joint_position[0];
  EXPECT_NEAR(t, 1.5, 1e-4);
  EXPECT_NEAR(rocker_start + state.joint_position[3], angle(closed_form(t).rocker_end - Eigen::Vector2d(D, 0)), 1e-6);
}

// At rest the crank's torque holds a torque on the rocker's drive by virtual work: tau_crank dt + tau_rocker dr = 0.
TEST(ClosedLoop, AFourBarLinkagePassesTorqueOnByVirtualWork) {
  Device device;
  PhysicalScene scene = four_bar(1.0);
  scene.joints[3].drive.mode = Drive::Mode::torque;
  scene.joints[3].drive.compensates_gravity = false;
  Simulation simulation(device, scene);
  for (int i = 0; i < 100; ++i) simulation.step(std::vector<double>{0, 0.8});
  const double t = 1.0 + simulation.state().joint_position[0], d = 1e-6;
  const auto rocker = [](double at) { return angle(closed_form(at).rocker_end - Eigen::Vector2d(D, 0)); };
  const double ratio = (rocker(t + d) - rocker(t - d)) / (2 * d);
  EXPECT_NEAR(simulation.state().joint_effort[0], -0.8 * ratio, 1e-4 * std::abs(0.8 * ratio));
}

}  // namespace
}  // namespace pvg
