// Planned motion: it arrives, it goes straight where it must, and no sample leaves the limits.
#include "host/robot/plan_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "host/base/error.hpp"
#include "host/robot/joint_path.hpp"

namespace pvg {
namespace {

const RobotModel& arm() {
  static const RobotModel model = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  return model;
}

Pose at(double x, double y, double z, double yaw = 0) {
  // the tool's z axis points down
  return Eigen::Translation3d(x, y, z) * Eigen::AngleAxisd(yaw, Vec3::UnitZ()) *
         Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX());
}

MotionSetup setup(double time_step = 0.01) {
  MotionSetup setup;
  setup.base = Eigen::Translation3d(-0.5, 0, 0.02) * Eigen::AngleAxisd(0.1, Vec3::UnitZ());
  setup.tool_link = arm().link("fr3_link8");
  setup.flange_to_tool = Eigen::Translation3d(0, 0, 0.2) * Eigen::AngleAxisd(-std::numbers::pi / 4, Vec3::UnitZ());
  setup.q_start = (VectorXd(7) << 0, -0.785, 0, -2.356, 0, 1.571, 0.785).finished();
  setup.n_gripper_joints = 2;
  setup.gripper_start = 0.04;
  setup.objects["beaker"] = Eigen::Translation3d(0.05, 0.15, 0) * Eigen::AngleAxisd(0.5, Vec3::UnitZ());
  setup.objects["scale"] = Pose(Eigen::Translation3d(0.02, -0.2, 0.05));
  setup.time_step = time_step;
  return setup;
}

// seize the beaker, put it on the scale
std::vector<MotionElement> pick_and_place() {
  using Type = MotionElement::Type;
  return {{.type = Type::approach, .object = "beaker", .target = at(0, 0, 0.18), .is_straight = false},
          {.type = Type::approach, .object = "beaker", .target = at(0, 0, 0.06)},
          {.type = Type::close, .gripper = 0.022},
          {.type = Type::lift, .object = "beaker", .target = at(0, 0, 0.20)},
          {.type = Type::carry, .object = "scale", .target = at(0, 0, 0.15)},
          {.type = Type::lower, .object = "scale", .target = at(0, 0, 0.07)},
          {.type = Type::wait, .duration = 0.3},
          {.type = Type::open, .gripper = 0.04},
          {.type = Type::retreat, .object = "scale", .target = at(0, 0, 0.2)}};
}

Pose tool_at(const MotionSetup& setup, const Eigen::RowVectorXd& row) {
  return setup.base * tool_pose(arm(), row.head(7).transpose(), setup.tool_link, setup.flange_to_tool);
}

Eigen::Index last_row(const JointTrajectory& trajectory, int element) {
  for (Eigen::Index k = trajectory.q.rows() - 1; k >= 0; --k)
    if (trajectory.element[k] == element) return k;
  return -1;
}

TEST(PlanMotion, EveryElementEndsAtItsTarget) {
  const MotionSetup s = setup();
  const std::vector<MotionElement> elements = pick_and_place();
  const JointTrajectory trajectory = plan_motion(arm(), s, elements);
  const double seconds = double(trajectory.q.rows()) * trajectory.time_step;
  std::printf("pick and place takes %.2f s\n", seconds);
  EXPECT_GT(seconds, 6);
  EXPECT_LT(seconds, 11);
  ASSERT_EQ(trajectory.element.size(), std::size_t(trajectory.q.rows()));
  for (int i = 0; i < int(elements.size()); ++i) {
    const Eigen::RowVectorXd row = trajectory.q.row(last_row(trajectory, i));
    if (elements[i].object.empty()) continue;
    const Pose wanted = s.objects.at(elements[i].object) * elements[i].target;
    EXPECT_LT(pose_difference(tool_at(s, row), wanted).norm(), 1e-6) << "element " << i;
  }
  EXPECT_EQ(trajectory.q(last_row(trajectory, 2), 7), 0.022);
  EXPECT_EQ(trajectory.q(last_row(trajectory, 2), 8), 0.022);
  EXPECT_EQ(trajectory.q(trajectory.q.rows() - 1, 8), 0.04);
}

TEST(PlanMotion, StraightElementsKeepToTheirLine) {
  const MotionSetup s = setup();
  const JointTrajectory trajectory = plan_motion(arm(), s, pick_and_place());
  for (const int element : {1, 3, 4, 5, 8}) {
    const Pose start = tool_at(s, trajectory.q.row(last_row(trajectory, element - 1)));
    const Pose end = tool_at(s, trajectory.q.row(last_row(trajectory, element)));
    const Vec3 line = end.translation() - start.translation();
    for (Eigen::Index k = 0; k < trajectory.q.rows(); ++k) {
      if (trajectory.element[k] != element) continue;
      const Vec3 way = tool_at(s, trajectory.q.row(k)).translation() - start.translation();
      EXPECT_LT(way.cross(line.normalized()).norm(), 1e-5) << "step " << k;
    }
  }
}

// Differences of the samples are means of the derivatives, so they must not exceed the limits either.
void expect_within_limits(const MotionSetup& s, const JointTrajectory& trajectory) {
  const double h = trajectory.time_step;
  Eigen::MatrixXd q(trajectory.q.rows() + 6, trajectory.q.cols());  // at rest before and after
  q << trajectory.q.row(0).replicate(3, 1), trajectory.q, trajectory.q.bottomRows(1).replicate(3, 1);
  for (int k = 0; k < 3; ++k) q.row(k) << s.q_start.transpose(), Eigen::RowVector2d::Constant(s.gripper_start);
  for (int i = 0; i < 7; ++i) {
    const RobotJoint& joint = arm().joints[i];
    for (Eigen::Index k = 3; k < q.rows(); ++k) {
      const double velocity = (q(k, i) - q(k - 1, i)) / h;
      const double acceleration = (q(k, i) - 2 * q(k - 1, i) + q(k - 2, i)) / (h * h);
      const double jerk = (q(k, i) - 3 * q(k - 1, i) + 3 * q(k - 2, i) - q(k - 3, i)) / (h * h * h);
      ASSERT_GE(q(k, i), joint.lower);
      ASSERT_LE(q(k, i), joint.upper);
      const double here = velocity_limit(joint, q(k, i), velocity > 0),
                   before = velocity_limit(joint, q(k - 1, i), velocity > 0);
      ASSERT_LE(std::abs(velocity), std::max(here, before)) << joint.name << " step " << k - 3;
      ASSERT_LE(std::abs(acceleration), joint.acceleration) << joint.name << " step " << k - 3;
      ASSERT_LE(std::abs(jerk), joint.jerk) << joint.name << " step " << k - 3;
    }
  }
  for (Eigen::Index k = 1; k < q.rows(); ++k)
    ASSERT_LE(std::abs(q(k, 7) - q(k - 1, 7)), s.gripper_speed * h * (1 + 1e-9));
}

TEST(PlanMotion, NoSampleLeavesTheLimitsAtFullSpeed) {
  for (const double h : {0.02, 0.01, 0.002}) {
    const MotionSetup s = setup(h);
    std::vector<MotionElement> elements = pick_and_place();
    for (MotionElement& element : elements) element.speed = 1;
    expect_within_limits(s, plan_motion(arm(), s, elements));
  }
}

TEST(PlanMotion, FullSpeedUsesTheLimits) {
  const MotionSetup s = setup(0.001);
  std::vector<MotionElement> elements = pick_and_place();
  elements.resize(1);
  elements[0].speed = 1;
  const JointTrajectory trajectory = plan_motion(arm(), s, elements);
  double highest = 0;  // share of a limit
  for (Eigen::Index k = 2; k < trajectory.q.rows(); ++k)
    for (int i = 0; i < 7; ++i) {
      const Eigen::VectorXd column = trajectory.q.col(i);
      const double acceleration = (column[k] - 2 * column[k - 1] + column[k - 2]) / 1e-6;
      const double velocity = (column[k] - column[k - 1]) / 1e-3;
      highest = std::max({highest, std::abs(acceleration) / 10, std::abs(velocity) / arm().joints[i].velocity});
    }
  EXPECT_GT(highest, 0.95);
}

TEST(PlanMotion, TheSameAskedTwiceIsTheSame) {
  const MotionSetup s = setup();
  EXPECT_EQ(plan_motion(arm(), s, pick_and_place()).q, plan_motion(arm(), s, pick_and_place()).q);
}

TEST(PlanMotion, AnArcKeepsItsDistanceAndTurnsTheTool) {
  MotionSetup s = setup();
  using Type = MotionElement::Type;
  const Vec3 center(0.1, 0, 0.05), axis = Vec3(0, 1, 0);  // in the scale's frame, beside and below where the tool is
  std::vector<MotionElement> elements = {
      {.type = Type::approach, .object = "scale", .target = at(0, 0, 0.1), .is_straight = false},
      {.type = Type::follow_arc, .object = "scale", .center = center, .axis = axis, .angle = 0.6}};
  const JointTrajectory turned = plan_motion(arm(), s, elements);
  elements[1].turns_with_arc = false;
  const JointTrajectory upright = plan_motion(arm(), s, elements);
  const Pose frame = s.objects.at("scale");
  const Pose start = frame.inverse() * tool_at(s, turned.q.row(last_row(turned, 0)));
  // between the knots, every 5 mm, the way is a spline of the joints
  for (const JointTrajectory* trajectory : {&turned, &upright})
    for (Eigen::Index k = last_row(*trajectory, 0); k < trajectory->q.rows(); ++k) {
      const Pose tool = frame.inverse() * tool_at(s, trajectory->q.row(k));
      ASSERT_NEAR((tool.translation() - center).norm(), (start.translation() - center).norm(), 5e-5) << k;
      ASSERT_NEAR(tool.translation().y(), start.translation().y(), 5e-5) << k;
    }
  const Pose by_hand =
      Eigen::Translation3d(center) * Eigen::AngleAxisd(0.6, axis) * Eigen::Translation3d(-center) * start;
  const Pose end = frame.inverse() * tool_at(s, turned.q.bottomRows(1));
  EXPECT_LT(pose_difference(end, by_hand).norm(), 1e-6);
  const Pose end_upright = frame.inverse() * tool_at(s, upright.q.bottomRows(1));
  EXPECT_LT((end_upright.translation() - by_hand.translation()).norm(), 1e-6);
  EXPECT_LT((end_upright.linear() - start.linear()).norm(), 1e-6);
  expect_within_limits(s, turned);
}

TEST(PlanMotion, APathGoesThroughItsPosesSmoothly) {
  const MotionSetup s = setup();
  using Type = MotionElement::Type;
  const std::vector<MotionElement> elements = {
      {.type = Type::approach, .object = "scale", .target = at(0, 0, 0.1), .is_straight = false},
      {.type = Type::follow_path, .object = "scale", .path = {at(0, 0.1, 0.15), at(0, 0.2, 0.1, 0.3)}}};
  const JointTrajectory trajectory = plan_motion(arm(), s, elements);
  expect_within_limits(s, trajectory);
  double nearest = 1;
  for (Eigen::Index k = 0; k < trajectory.q.rows(); ++k)
    nearest = std::min(
        nearest, (tool_at(s, trajectory.q.row(k)).translation() - s.objects.at("scale") * Vec3(0, 0.1, 0.15)).norm());
  EXPECT_LT(nearest, 5e-3);  // between two samples
  EXPECT_LT(
      pose_difference(tool_at(s, trajectory.q.bottomRows(1)), s.objects.at("scale") * at(0, 0.2, 0.1, 0.3)).norm(),
      1e-6);
}

TEST(PlanMotion, ATargetInTheToolsFrameIsRelativeToWhereItIs) {
  const MotionSetup s = setup();
  using Type = MotionElement::Type;
  const std::vector<MotionElement> elements = {
      {.type = Type::approach, .object = "scale", .target = at(0, 0, 0.1), .is_straight = false},
      {.type = Type::retreat, .is_in_tool_frame = true, .target = Pose(Eigen::Translation3d(0, 0, -0.07))}};
  const JointTrajectory trajectory = plan_motion(arm(), s, elements);
  const Vec3 end = tool_at(s, trajectory.q.bottomRows(1)).translation();
  EXPECT_LT((end - s.objects.at("scale") * Vec3(0, 0, 0.17)).norm(), 1e-6);
}

TEST(PlanMotion, RobotsThatMoveTogetherBeginAndEndTogether) {
  const MotionSetup left = setup();
  MotionSetup right = setup();
  right.base = Eigen::Translation3d(-0.5, -0.9, 0.02) * left.base.inverse() * Pose(Eigen::Translation3d(-0.5, 0, 0.02));
  using Type = MotionElement::Type;
  const std::vector<MotionElement> elements = {
      {.type = Type::approach, .object = "scale", .target = at(0, 0, 0.1), .is_straight = false},
      {.type = Type::close, .robot = 1, .is_with_previous = true, .gripper = 0.03},
      {.type = Type::open, .robot = 1, .gripper = 0.04}};
  const std::vector<PlannedRobot> robots = {{arm(), left}, {arm(), right}};
  const std::vector<JointTrajectory> both = plan_motion(robots, elements);
  ASSERT_EQ(both.size(), 2u);
  ASSERT_EQ(both[0].q.rows(), both[1].q.rows());
  EXPECT_EQ(both[0].element, both[1].element);
  const Eigen::Index end = last_row(both[0], 0), pause = 10;  // 0.1 s of rest
  for (Eigen::Index k = 0; k < both[0].q.rows(); ++k) {
    // the closing hand takes as long as the arm's way, and stands with it
    if (k > 0 && k <= end - pause) {
      EXPECT_LT(both[1].q(k, 7), both[1].q(k - 1, 7)) << k;
    } else if (k > end - pause && k <= end) {
      EXPECT_EQ(both[1].q(k, 7), 0.03) << k;
    }
    if (k >= end - pause) {
      EXPECT_LT((both[0].q.row(k) - both[0].q.row(end)).norm(), 1e-12) << k;
    }
  }
}

// Two branches reach the same targets, such as with the elbow to the other side; the posture says which one is planned.
TEST(PlanMotion, APostureKeepsTheMotionsOfAllStartsInItsBranch) {
  MotionSetup s = setup();
  std::vector<MotionElement> elements = {{.target = at(0, 0.1, 0.3), .is_straight = false}};
  const auto end_of = [&] { return VectorXd(plan_motion(arm(), s, elements).q.bottomRows(1).leftCols(7).transpose()); };
  const VectorXd usual = end_of();
  const Pose target = s.base.inverse() * elements[0].target;
  const std::vector<VectorXd> branches =
      reach_pose(arm(), s.tool_link, s.flange_to_tool, target, s.q_start, {.n_solutions = 6, .margin = 0.02});
  ASSERT_FALSE(branches.empty());
  const VectorXd other = branches.back();
  ASSERT_GT((other - usual).cwiseAbs().maxCoeff(), 1.0);
  s.posture = other;
  for (const double shift : {-0.06, -0.02, 0.0, 0.03, 0.06}) {
    elements[0].target = at(shift, 0.1 - shift, 0.3, shift);
    const VectorXd q = end_of();
    EXPECT_LT((q - other).cwiseAbs().maxCoeff(), 0.5) << shift;
    const Pose reached = s.base * tool_pose(arm(), q, s.tool_link, s.flange_to_tool);
    EXPECT_LT(pose_difference(reached, elements[0].target).norm(), 1e-6) << shift;
  }
}

// Lifted and carried on without a stop: past the target between, near both straight lines, within the limits.
TEST(PlanMotion, ABlendedElementGoesOnIntoTheNextWithoutAStop) {
  const MotionSetup s = setup();
  std::vector<MotionElement> elements = pick_and_place();
  const JointTrajectory stops = plan_motion(arm(), s, elements);
  constexpr double RADIUS = 0.03;
  elements[3].blend_radius = RADIUS;
  const JointTrajectory blends = plan_motion(arm(), s, elements);
  const Vec3 start = tool_at(s, stops.q.row(last_row(stops, 2))).translation(),
             target = tool_at(s, stops.q.row(last_row(stops, 3))).translation(),
             end = tool_at(s, stops.q.row(last_row(stops, 4))).translation();
  const auto beside = [](const Vec3& point, const Vec3& from, const Vec3& to) {
    const double share = std::clamp((point - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    return (point - from - share * (to - from)).norm();
  };
  double slowest = 1, farthest = 0, nearest = 1;
  const Eigen::Index first = last_row(blends, 2) + 1, last = last_row(blends, 4);
  for (Eigen::Index k = first; k <= last; ++k) {
    const Vec3 at = tool_at(s, blends.q.row(k)).translation();
    nearest = std::min(nearest, (at - target).norm());
    farthest = std::max(farthest, std::min(beside(at, start, target), beside(at, target, end)));
    if ((at - target).norm() < RADIUS)
      slowest = std::min(slowest, (at - tool_at(s, blends.q.row(k - 1)).translation()).norm() / s.time_step);
  }
  EXPECT_GT(slowest, 0.05);  // [m/s]; where it stops it rests for ten steps
  EXPECT_GT(nearest, 1e-4);  // it cuts the corner
  EXPECT_LT(nearest, RADIUS);
  EXPECT_LT(farthest, RADIUS);
  expect_within_limits(s, blends);
  // before and after it is the same motion, and it has lost the rest and what is shared
  EXPECT_LT(blends.q.rows(), stops.q.rows() - 10);
  EXPECT_EQ(blends.q.topRows(first), stops.q.topRows(first));
  const Eigen::Index after = blends.q.rows() - 1 - last;
  EXPECT_EQ(blends.q.bottomRows(after), stops.q.bottomRows(after));
  EXPECT_TRUE(std::is_sorted(blends.element.begin(), blends.element.end()));
}

TEST(JointPath, DerivativesAreThoseOfTheSpline) {
  Eigen::MatrixXd knots(9, 2);
  for (int k = 0; k < 9; ++k) knots.row(k) << std::sin(k / 8.0), k / 8.0 * k / 8.0 * k / 8.0;
  const JointPath path(knots);
  for (const double s : {0.03, 0.2, 0.51, 0.77, 0.98}) {
    const double e = 1e-4;
    const JointPath::Point p = path.at(s), after = path.at(s + e), before = path.at(s - e);
    EXPECT_NEAR(p.q[0], std::sin(s), 2e-5);
    EXPECT_NEAR(p.q[1], s * s * s, 1e-12);  // a cubic is reproduced
    EXPECT_NEAR(p.third[1], 6, 1e-9);
    EXPECT_LT((p.first - (after.q - before.q) / (2 * e)).norm(), 1e-6);
    EXPECT_LT((p.second - (after.first - before.first) / (2 * e)).norm(), 1e-6);
    EXPECT_LT((p.third - (after.second - before.second) / (2 * e)).norm(), 1e-6);
  }
}

TEST(JointPath, ShortestDurationIsTheOneByHandForEachLimit) {
  const double way = 2;  // of a straight line: largest s', s'' and s''' are 15/8, 10/sqrt(3) and 60
  const JointPath path((Eigen::MatrixXd(2, 1) << -1, 1).finished());
  RobotJoint joint;
  const auto duration = [&](double velocity, double acceleration, double jerk, double share) {
    joint.velocity = velocity;
    joint.acceleration = acceleration;
    joint.jerk = jerk;
    return shortest_duration(path, {joint}, {.share = share});
  };
  EXPECT_NEAR(duration(0.5, 1e9, 1e9, 1), 1.875 * way / 0.5, 2e-3 * 7.5);  // the limits are kept by 0.1 %
  EXPECT_NEAR(duration(0.5, 1e9, 1e9, 0.25), 4 * 1.875 * way / 0.5, 2e-3 * 30);
  EXPECT_NEAR(duration(1e9, 2, 1e9, 1), std::sqrt(10 / std::sqrt(3.0) * way / 2), 2e-3 * 2.4);
  EXPECT_NEAR(duration(1e9, 2, 1e9, 0.25), 2 * std::sqrt(10 / std::sqrt(3.0) * way / 2), 2e-3 * 4.8);
  EXPECT_NEAR(duration(1e9, 1e9, 15, 1), 2, 2e-3 * 2);
  joint.envelope = VelocityEnvelope{.offset = 0.1, .slope = 1, .upper = 1.005, .lower = 9};
  EXPECT_TRUE(std::isinf(duration(0.5, 1e9, 1e9, 1)));  // at 1 the limit is zero
  joint.envelope->upper = 1.2;                          // at 1 it is 0.347, but in the middle still 0.5
  EXPECT_GT(duration(0.5, 1e9, 1e9, 1), 7.5);
  EXPECT_LT(duration(0.5, 1e9, 1e9, 1), 7.6);
}

TEST(JointPath, VelocityLimitShrinksTowardTheEnds) {
  const RobotJoint& joint = arm().joints[0];
  EXPECT_EQ(velocity_limit(joint, 0, true), 2.62);
  EXPECT_NEAR(velocity_limit(joint, 2.7, true), -0.30 + std::sqrt(12 * (2.7501 - 2.7)), 1e-12);
  EXPECT_NEAR(velocity_limit(joint, -2.7, false), -0.30 + std::sqrt(12 * (2.7501 - 2.7)), 1e-12);
  EXPECT_EQ(velocity_limit(joint, -2.7, true), 2.62);
  EXPECT_EQ(velocity_limit(joint, 2.7499, true), 0);
  const RobotJoint& elbow = arm().joints[3];  // its range lies below zero
  EXPECT_NEAR(velocity_limit(elbow, -0.2, true), -0.30 + std::sqrt(8 * (-0.1458 + 0.2)), 1e-12);
  EXPECT_NEAR(velocity_limit(elbow, -3.0, false), -0.30 + std::sqrt(8 * (3.0481 - 3.0)), 1e-12);
}

std::string refusal(const MotionSetup& setup, const std::vector<MotionElement>& elements) {
  try {
    plan_motion(arm(), setup, elements);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "(was accepted)";
}

TEST(PlanMotion, WhatCannotBeDoneIsNamed) {
  const MotionSetup s = setup();
  std::vector<MotionElement> elements = pick_and_place();
  elements[0].target = at(1.2, 0, 0.1);
  std::string message = refusal(s, elements);
  EXPECT_NE(message.find("motion element 1 (approach relative to 'beaker'): its target"), std::string::npos) << message;
  EXPECT_NE(message.find("cannot be reached"), std::string::npos) << message;

  elements[0].place = "task.yaml:7";
  EXPECT_EQ(refusal(s, elements).rfind("task.yaml:7: motion element 1", 0), 0u) << refusal(s, elements);

  elements = pick_and_place();
  elements[3].target = at(0, 0, 1.5);
  message = refusal(s, elements);
  EXPECT_NE(message.find("motion element 4 (lift relative to 'beaker'): the tool's straight line"), std::string::npos)
      << message;

  elements = pick_and_place();
  elements[4].object = "balance";
  message = refusal(s, elements);
  EXPECT_NE(message.find("motion element 5 (carry relative to 'balance'): there is no object"), std::string::npos)
      << message;

  elements = pick_and_place();
  elements[2].duration = 0.01;
  message = refusal(s, elements);
  EXPECT_NE(message.find("motion element 3 (close): its duration of 0.010 s is shorter"), std::string::npos) << message;

  elements = pick_and_place();
  elements[1].blend_radius = 0.02;  // the gripper closes next
  message = refusal(s, elements);
  EXPECT_NE(message.find("motion element 2 (approach relative to 'beaker'): `blend_radius` needs a next element"),
            std::string::npos)
      << message;
  elements[1].blend_radius = 0;
  elements[8].blend_radius = 0.02;  // nothing comes next
  EXPECT_NE(refusal(s, elements).find("motion element 9"), std::string::npos) << refusal(s, elements);

  elements = pick_and_place();
  elements[1].speed = 1.5;
  message = refusal(s, elements);
  EXPECT_NE(message.find("a number in (0, 1]"), std::string::npos) << message;
}

}  // namespace
}  // namespace pvg
