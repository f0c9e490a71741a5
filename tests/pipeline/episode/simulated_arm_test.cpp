// The arm in the simulator: it hangs in its drives, their torques carry its weight, and it follows what was planned.
#include <gtest/gtest.h>

#include "host/physics/step/simulation.hpp"
#include "host/robot/add_robot.hpp"
#include "host/robot/friction_feedforward.hpp"
#include "host/robot/plan_motion.hpp"

namespace pvg {
namespace {

struct ArmScene {
  RobotModel model = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  VectorXd home = (VectorXd(7) << 0.1, -0.785, 0.2, -2.356, -0.1, 1.571, 0.785).finished();
  Scene scene;
  AddedRobot added;

  explicit ArmScene(const RobotOptions& options = {}) {
    added = add_robot(scene, model, Pose::Identity(), home, options);
    scene.solver.time_step = 0.02;
  }
  std::vector<double> targets(const VectorXd& q) const { return {q.data(), q.data() + q.size()}; }

  // torque of each joint that holds the arm against gravity: minus the work of the weights per turn   [N m]
  VectorXd holding_torque(const VectorXd& q) const {
    VectorXd torque = VectorXd::Zero(7);
    for (std::size_t i = 0; i < model.links.size(); ++i) {
      const Pose center(Eigen::Translation3d(model.links[i].center_of_mass));
      const Vec3 weight = model.links[i].mass * scene.gravity;
      torque -= tool_jacobian(model, q, int(i), center).topRows<3>().transpose() * weight;
    }
    return torque;
  }
};

TEST(SimulatedArm, HangsStillAtHomeAndItsDrivesCarryItsWeight) {
  for (const bool compensates : {true, false}) {
    const ArmScene arm({.stiffness = 1e5, .compensates_gravity = compensates});
    Device device;
    Simulation simulation(device, arm.scene);
    for (int k = 0; k < 25; ++k) simulation.step(arm.targets(arm.home));
    const WorldState& state = simulation.state();
    const VectorXd q = Eigen::Map<const VectorXd>(state.joint_position.data(), 7);
    const VectorXd torque = Eigen::Map<const VectorXd>(state.joint_effort.data(), 7);
    const VectorXd expected = arm.holding_torque(q);
    // without feed-forward the arm sags by torque / stiffness
    const VectorXd sag = compensates ? VectorXd::Zero(7) : VectorXd(-expected / 1e5);
    EXPECT_LT((q - arm.home - sag).cwiseAbs().maxCoeff(), 2e-5) << compensates;
    EXPECT_LT((torque - expected).cwiseAbs().maxCoeff(), 0.01 * expected.cwiseAbs().maxCoeff())
        << torque.transpose() << "\nexpected " << expected.transpose();
  }
}

// a straight line of 245 mm
MotionElement line(const ArmScene& arm) {
  MotionElement element;
  element.target = tool_pose(arm.model, arm.home, arm.model.link("fr3_link8"));
  element.target.translation() += Vec3(0.1, 0.2, -0.1);
  return element;
}

JointTrajectory plan_of(const ArmScene& arm, const MotionElement& element) {
  MotionSetup setup;
  setup.tool_link = arm.model.link("fr3_link8");
  setup.q_start = arm.home;
  setup.time_step = arm.scene.solver.time_step;
  return plan_motion(arm.model, setup, std::span(&element, 1));
}

TEST(SimulatedArm, FollowsAPlannedMotion) {
  const ArmScene arm;
  const MotionElement element = line(arm);
  const JointTrajectory plan = plan_of(arm, element);
  Device device;
  Simulation simulation(device, arm.scene);
  double worst = 0;
  for (Eigen::Index k = 0; k < plan.q.rows(); ++k) {
    simulation.step(arm.targets(plan.q.row(k).transpose()));
    const VectorXd q = Eigen::Map<const VectorXd>(simulation.state().joint_position.data(), 7);
    worst = std::max(worst, (q - plan.q.row(k).transpose()).cwiseAbs().maxCoeff());
  }
  std::printf("%d steps, largest lag %.2e rad\n", int(plan.q.rows()), worst);
  EXPECT_LT(worst, 2e-3);
  const VectorXd q = Eigen::Map<const VectorXd>(simulation.state().joint_position.data(), 7);
  const Pose reached = tool_pose(arm.model, q, arm.model.link("fr3_link8"));
  EXPECT_LT((reached.translation() - element.target.translation()).norm(), 2e-4);
}

// largest distance of joints 2 and 4, whose bearings brake, from the plan [rad]
double lag_of_braked_arm(bool feeds_forward) {
  ArmScene arm({.stiffness = 400, .damping = 40});
  arm.scene.effects = {{"joint_viscous_friction", "fr3_joint2", {50}},
                       {"joint_coulomb_friction", "fr3_joint4", {8, 1e-3}}};
  const JointTrajectory plan = plan_of(arm, line(arm));
  Eigen::MatrixXd targets = plan.q;
  for (Eigen::Index c = 0; c < targets.cols() && feeds_forward; ++c) {
    const std::vector<double> lead =
        friction_lead(arm.scene.joints[std::size_t(arm.added.joints[std::size_t(c)])], arm.scene.effects, arm.home[c],
                      std::span(plan.q.col(c).data(), std::size_t(plan.q.rows())), plan.time_step);
    targets.col(c) += Eigen::Map<const VectorXd>(lead.data(), targets.rows());
  }
  Device device;
  Simulation simulation(device, arm.scene);
  double worst = 0;
  for (Eigen::Index k = 0; k < plan.q.rows(); ++k) {
    simulation.step(arm.targets(targets.row(k).transpose()));
    for (const Eigen::Index joint : {1, 3})
      worst = std::max(worst, std::abs(simulation.state().joint_position[std::size_t(joint)] - plan.q(k, joint)));
  }
  return worst;
}

TEST(SimulatedArm, WithFrictionFedForwardBrakedJointsHardlyLag) {
  const double without = lag_of_braked_arm(false), with = lag_of_braked_arm(true);
  std::printf("largest lag of a braked joint: %.2e rad without, %.2e rad with feedforward\n", without, with);
  EXPECT_LT(with, without / 4);
}

}  // namespace
}  // namespace pvg
