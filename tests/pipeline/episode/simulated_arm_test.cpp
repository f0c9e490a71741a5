// The arm in the simulator: it hangs in its drives, their torques carry its weight, and it follows what was planned.
#include <gtest/gtest.h>

#include "host/physics/step/simulation.hpp"
#include "host/robot/add_robot.hpp"
#include "host/robot/plan_motion.hpp"

namespace pvg {
namespace {

struct ArmScene {
  RobotModel model = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  VectorXd home = (VectorXd(7) << 0.1, -0.785, 0.2, -2.356, -0.1, 1.571, 0.785).finished();
  Scene scene;

  explicit ArmScene(const RobotOptions& options = {}) {
    add_robot(scene, model, Pose::Identity(), home, options);
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

TEST(SimulatedArm, FollowsAPlannedMotion) {
  const ArmScene arm;
  MotionSetup setup;
  setup.tool_link = arm.model.link("fr3_link8");
  setup.q_start = arm.home;
  setup.time_step = arm.scene.solver.time_step;
  MotionElement element;
  element.target = tool_pose(arm.model, arm.home, setup.tool_link);
  element.target.translation() += Vec3(0.1, 0.2, -0.1);
  const JointTrajectory plan = plan_motion(arm.model, setup, std::span(&element, 1));
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
  const Pose reached = tool_pose(arm.model, q, setup.tool_link);
  EXPECT_LT((reached.translation() - element.target.translation()).norm(), 2e-4);
}

}  // namespace
}  // namespace pvg
