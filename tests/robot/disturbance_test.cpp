// Pushes of a hand: where it goes, when, and that it comes back.
#include "host/robot/disturbance.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

constexpr double PUSH_STEP = 0.02;

struct DisturbedArm : testing::Test {
  RobotModel model = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  PushedRobot robot{model, model.link("fr3_link8"), Pose(Eigen::Translation3d(0, 0, 0.15))};
  VectorXd home = (VectorXd(7) << 0.1, -0.785, 0.2, -2.356, -0.1, 1.571, 0.785).finished();

  Pose tool(const VectorXd& q) const { return tool_pose(model, q, robot.tool_link, robot.flange_to_tool); }
  // joint 1 turns, 8 mm of the hand's way per step; two columns of a gripper follow
  Eigen::MatrixXd turning(int n) const {
    Eigen::MatrixXd q = home.transpose().replicate(n, 1);
    for (int i = 0; i < n; ++i) q(i, 0) += 0.015 * i;
    Eigen::MatrixXd with_gripper = Eigen::MatrixXd::Constant(n, 9, 0.02);
    with_gripper.leftCols(7) = q;
    return with_gripper;
  }
  Eigen::MatrixXd resting(int n) const { return home.transpose().replicate(n, 1); }
};

// of a hand that rests the offset is what was asked for, in the tool's frame; second order in it: 20 mm of about 0.5 m
TEST_F(DisturbedArm, AHandAtRestGoesByItsOffsetAndItsTurnAndComesBack) {
  const PushAside push{0, 0.4, Vec3(0.012, -0.008, 0.014), Vec3(0.02, 0, -0.03)};
  const Eigen::MatrixXd q = resting(60),
                        shift = pushed_aside(robot, q, std::vector<bool>(60, true), {&push, 1}, PUSH_STEP);
  const Pose from = tool(home), to = tool(home + shift.row(9).transpose());  // the middle: u = 1/2
  const Pose moved = from.inverse() * to;
  EXPECT_LT((moved.translation() - push.offset).norm(), 1.5e-3);
  EXPECT_LT((pose_difference(Pose::Identity(), moved).tail<3>() - push.turn).norm(), 3e-3);
  EXPECT_NEAR(shift.row(4).norm(), 64 * std::pow(0.25 * 0.75, 3) * shift.row(9).norm(), 1e-12);  // u = 1/4
  EXPECT_EQ(shift.row(19).norm(), 0);
  EXPECT_EQ(shift.bottomRows(40).norm(), 0);
  EXPECT_GT(shift.row(18).norm(), 0);
}

TEST_F(DisturbedArm, AHandUnderWayGoesBesideItsWayOnly) {
  const PushAside push{0, 0.4, Vec3(0.01, 0.01, 0.01)};
  const Eigen::MatrixXd q = turning(40),
                        shift = pushed_aside(robot, q, std::vector<bool>(40, true), {&push, 1}, PUSH_STEP);
  ASSERT_EQ(shift.cols(), 7);
  const VectorXd planned = q.row(9).head(7).transpose();
  const Vec3 moved = tool(planned + shift.row(9).transpose()).translation() - tool(planned).translation();
  const Vec3 way =
      (tool(q.row(10).head(7).transpose()).translation() - tool(q.row(8).head(7).transpose()).translation())
          .normalized();
  EXPECT_LT(std::abs(moved.dot(way)), 0.05 * moved.norm());
  const Vec3 offset = tool(q.row(10).head(7).transpose()).linear() * push.offset;  // u = 1/2 is between two steps
  EXPECT_NEAR(moved.norm(), (offset - way * way.dot(offset)).norm(), 5e-4);
}

TEST_F(DisturbedArm, PushesComeWhereTheyMayOneAfterTheOther) {
  std::vector<bool> may(100, true);
  for (int i = 40; i < 60; ++i) may[std::size_t(i)] = false;
  std::vector<PushAside> pushes;
  for (const double start : {0.99, 0.0, 0.99}) pushes.push_back({start, 0.3, Vec3(0, 0.01, 0)});
  const Eigen::MatrixXd shift = pushed_aside(robot, resting(100), may, pushes, PUSH_STEP);
  int n_begun = 0, n_pushed = 0;
  for (int i = 0; i < 100; ++i) {
    const bool is_pushed = shift.row(i).norm() > 0;
    EXPECT_FALSE(is_pushed && !may[std::size_t(i)]) << i;
    n_begun += is_pushed && (i == 0 || shift.row(i - 1).norm() == 0);
    n_pushed += is_pushed;
  }
  EXPECT_EQ(n_begun, 3);
  EXPECT_EQ(n_pushed, 3 * 14);  // the 15th step of each is back on the way
}

TEST_F(DisturbedArm, APushThatFitsNowhereIsRefused) {
  const PushAside push{0.5, 0.5, Vec3(0, 0.01, 0)};
  std::vector<bool> may(60, true);
  for (std::size_t i = 0; i < may.size(); i += 20) may[i] = false;
  expect_error<UsageError>(
      [&] {
        pushed_aside(robot, resting(60), may, {&push, 1}, PUSH_STEP);
      },
      {"0.5 s", "duration", "during"});
}

TEST_F(DisturbedArm, JointsStayWithinTheirLimits) {
  const PushAside push{0, 0.4, Vec3(0, 0, 0.2)};
  Eigen::MatrixXd q = resting(40);
  const double upper = model.joints[std::size_t(model.actuated[3])].upper;
  q.col(3).setConstant(upper - 1e-3);
  const Eigen::MatrixXd shift = pushed_aside(robot, q, std::vector<bool>(40, true), {&push, 1}, PUSH_STEP);
  EXPECT_NEAR((q + shift).col(3).maxCoeff(), upper, 1e-12);
}

}  // namespace
}  // namespace pvg
