// Kinematics: the maker's known pose, the Jacobian against differences, inverse kinematics against forward kinematics.
#include "host/robot/kinematics.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <numbers>
#include <random>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr double PI = std::numbers::pi;

struct Arm {
  RobotModel model = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  int flange = model.link("fr3_link8");
  VectorXd home = (VectorXd(7) << 0, -PI / 4, 0, -3 * PI / 4, 0, PI / 2, PI / 4).finished();

  VectorXd random(std::mt19937& engine) const {
    VectorXd q(7);
    for (int i = 0; i < 7; ++i)
      q[i] = std::uniform_real_distribution(model.joints[i].lower, model.joints[i].upper)(engine);
    return q;
  }
  bool is_within_limits(const VectorXd& q) const {
    for (int i = 0; i < 7; ++i)
      if (q[i] < model.joints[i].lower || q[i] > model.joints[i].upper) return false;
    return true;
  }
};

TEST(Kinematics, FlangeIsWhereTheMakerSaysItIs) {
  const Arm arm;
  const Pose flange = tool_pose(arm.model, arm.home, arm.flange);
  EXPECT_LT((flange.translation() - Vec3(0.306891, 0, 0.590282)).norm(), 1e-6);  // given to six digits
  const Eigen::Quaterniond expected(0, 0.92388, -0.38268, 0);                    // w, x, y, z; to five digits
  EXPECT_LT(Eigen::Quaterniond(flange.linear()).angularDistance(expected), 2e-5);
}

TEST(Kinematics, BaseMovesEverythingAlong) {
  const Arm arm;
  const Pose base = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vec3(1, 2, 2) / 3);
  const std::vector<Pose> at_origin = link_poses(arm.model, arm.home), moved = link_poses(arm.model, arm.home, base);
  for (std::size_t i = 0; i < moved.size(); ++i)
    EXPECT_LT((moved[i].matrix() - (base * at_origin[i]).matrix()).norm(), 1e-14);
}

TEST(Kinematics, PoseDifferenceIsTheRotationVectorThatLeadsThere) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  for (const double angle : {0.0, 1e-9, 1e-4, 1.0, 3.0, PI - 1e-6}) {
    const Vec3 axis = Vec3(normal(engine), normal(engine), normal(engine)).normalized();
    const Pose from(Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine)).normalized());
    Pose to = from;
    to.linear() = Eigen::AngleAxisd(angle, axis) * from.linear();
    to.translation() = from.translation() + Vec3(1, 2, 3);
    const Eigen::Matrix<double, 6, 1> difference = pose_difference(from, to);
    EXPECT_LT((difference.head<3>() - Vec3(1, 2, 3)).norm(), 1e-14);
    EXPECT_LT((difference.tail<3>() - angle * axis).norm(), 1e-9 * (1 + angle)) << angle;
  }
}

TEST(Kinematics, JacobianIsTheDerivativeOfThePose) {
  const Arm arm;
  std::mt19937 engine(5);
  const Pose tool = Eigen::Translation3d(0.01, -0.02, 0.2) * Eigen::AngleAxisd(0.3, Vec3::UnitY());
  for (int sample = 0; sample < 20; ++sample) {
    const VectorXd q = arm.random(engine);
    const Jacobian jacobian = tool_jacobian(arm.model, q, arm.flange, tool);
    for (int i = 0; i < 7; ++i) {
      const double step = 1e-6;
      VectorXd before = q, after = q;
      before[i] -= step;
      after[i] += step;
      const Eigen::Matrix<double, 6, 1> difference = pose_difference(tool_pose(arm.model, before, arm.flange, tool),
                                                                     tool_pose(arm.model, after, arm.flange, tool));
      EXPECT_LT((difference / (2 * step) - jacobian.col(i)).norm(), 1e-8);
    }
  }
}

TEST(InverseKinematics, FindsReachablePosesWithinTheLimits) {
  const Arm arm;
  std::mt19937 engine(7);
  const int n = std::getenv("PVG_IK_POSES") ? std::atoi(std::getenv("PVG_IK_POSES")) : 300;
  int found = 0;
  const auto start = std::chrono::steady_clock::now();
  for (int sample = 0; sample < n; ++sample) {
    const Pose target = tool_pose(arm.model, arm.random(engine), arm.flange);
    const std::vector<VectorXd> q = reach_pose(arm.model, arm.flange, Pose::Identity(), target, arm.home);
    if (q.empty()) continue;
    ++found;
    ASSERT_TRUE(arm.is_within_limits(q[0]));
    ASSERT_LT(pose_difference(tool_pose(arm.model, q[0], arm.flange), target).norm(), 1e-6);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("found", std::to_string(found) + " of " + std::to_string(n));
  std::printf("found %d of %d poses, %.3f ms each\n", found, n, 1e3 * seconds / n);
  EXPECT_GE(found, 0.995 * n);
}

TEST(InverseKinematics, TakesTheNearestOfSeveralSolutionsAndRepeatsItself) {
  const Arm arm;
  std::mt19937 engine(11);
  const InverseKinematics settings{.n_solutions = 5, .margin = 0.05};
  for (int sample = 0; sample < 10; ++sample) {
    const Pose target = tool_pose(arm.model, 0.7 * arm.home + 0.3 * arm.random(engine), arm.flange);
    const std::vector<VectorXd> q = reach_pose(arm.model, arm.flange, Pose::Identity(), target, arm.home, settings);
    ASSERT_FALSE(q.empty());
    for (std::size_t i = 1; i < q.size(); ++i) EXPECT_LE((q[i - 1] - arm.home).norm(), (q[i] - arm.home).norm());
    EXPECT_EQ(q, reach_pose(arm.model, arm.flange, Pose::Identity(), target, arm.home, settings));
  }
}

TEST(InverseKinematics, FollowsASmallMotionByASmallChange) {
  const Arm arm;
  Pose target = tool_pose(arm.model, arm.home, arm.flange);
  target.translation() += Vec3(0.002, -0.001, 0.003);
  const auto q = follow_pose(arm.model, arm.flange, Pose::Identity(), target, arm.home);
  ASSERT_TRUE(q);
  EXPECT_LT((*q - arm.home).cwiseAbs().maxCoeff(), 0.03);
}

TEST(InverseKinematics, PostureMovesTheElbowAndNotTheTool) {
  const Arm arm;
  const Pose target = tool_pose(arm.model, arm.home, arm.flange);
  VectorXd turned = arm.home;
  turned[0] += 0.4;
  const auto plain = follow_pose(arm.model, arm.flange, Pose::Identity(), target, turned);
  const auto pulled = follow_pose(arm.model, arm.flange, Pose::Identity(), target, turned,
                                  {.max_iterations = 400, .posture = arm.home, .posture_gain = 0.2});
  ASSERT_TRUE(plain && pulled);
  EXPECT_LT(pose_difference(tool_pose(arm.model, *pulled, arm.flange), target).norm(), 1e-6);
  EXPECT_LT((*pulled - arm.home).norm(), (*plain - arm.home).norm());
}

TEST(InverseKinematics, AnUnreachablePoseHasNoSolution) {
  const Arm arm;
  Pose target = tool_pose(arm.model, arm.home, arm.flange);
  target.translation() = Vec3(1.5, 0, 0.5);
  EXPECT_TRUE(reach_pose(arm.model, arm.flange, Pose::Identity(), target, arm.home).empty());
}

TEST(Kinematics, WrongNumberOfPositionsIsRefused) {
  const Arm arm;
  EXPECT_THROW(link_poses(arm.model, VectorXd::Zero(6)), UsageError);
}

}  // namespace
}  // namespace pvg
