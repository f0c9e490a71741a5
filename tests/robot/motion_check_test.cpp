// The check of written trajectories: a good one passes, and each limit that one sample leaves is named.
#include "host/robot/motion_check.hpp"

#include <gtest/gtest.h>

#include "host/robot/joint_path.hpp"

namespace pvg {
namespace {

// one joint that goes from 0 to `way` by the time law in n steps of 10 ms
struct OneJoint {
  RobotModel model;
  VectorXd start = VectorXd::Zero(1);
  OneJoint() {
    model.links.resize(2);
    RobotJoint joint;
    joint.name = "elbow";
    joint.type = Joint::Type::revolute;
    joint.lower = -3;
    joint.upper = 3;
    joint.velocity = 2;
    joint.acceleration = 10;
    joint.jerk = 200;
    model.joints = {joint};
    model.actuated = {0};
  }
  static Eigen::MatrixXd motion(double way, int n) {
    Eigen::MatrixXd q(n, 1);
    for (int k = 0; k < n; ++k) q(k, 0) = way * smoothstep(double(k + 1) / n).value;
    return q;
  }
  std::string left(const Eigen::MatrixXd& q) const { return limit_left(model, start, q, 0.01).value_or("none"); }
};

TEST(MotionCheck, ALawfulMotionPasses) {
  const OneJoint one;
  // largest velocity 15/8 way / T = 1.875, acceleration 10/sqrt(3) way / T^2 = 5.8, jerk 60 way / T^3 = 60
  EXPECT_EQ(one.left(OneJoint::motion(1, 100)), "none");
}

TEST(MotionCheck, EachLimitIsNamedWithItsSample) {
  OneJoint one;
  // 30 u^2 (1 - u)^2 1.2 reaches 2 at u = 0.380: the mean of the step that ends at 0.39 s is the first above it
  const std::string fast = one.left(OneJoint::motion(1.2, 100));
  EXPECT_EQ(fast.find("elbow at 0.390 s: its velocity"), 0u) << fast;
  EXPECT_NE(one.left(OneJoint::motion(0.4, 40)).find("jerk"), std::string::npos);  // 60 * 0.4 / 0.064 = 375
  one.model.joints[0].jerk = 1e6;
  EXPECT_NE(one.left(OneJoint::motion(0.4, 40)).find("acceleration"), std::string::npos);  // 5.77 * 0.4 / 0.16 = 14.4
  one.model.joints[0].upper = 0.9;
  EXPECT_NE(one.left(OneJoint::motion(1, 100)).find("position"), std::string::npos);
}

TEST(MotionCheck, AMotionThatDoesNotEndAtRestIsNamed) {
  OneJoint one;
  one.model.joints[0].jerk = 0;
  Eigen::MatrixXd q = OneJoint::motion(1, 100).topRows(50);
  EXPECT_NE(one.left(q).find("at 0.510 s: its acceleration"), std::string::npos) << one.left(q);
}

TEST(MotionCheck, TheBoundThatDependsOnThePositionCounts) {
  OneJoint one;
  // at 0.5, in the middle, where the motion is fastest (1.875): sqrt(4 (1.2 - 0.5)) = 1.67
  one.model.joints[0].envelope = VelocityEnvelope{.offset = 0, .slope = 4, .upper = 1.2, .lower = 9};
  EXPECT_NE(one.left(OneJoint::motion(1, 100)).find("velocity"), std::string::npos);
  one.model.joints[0].envelope->upper = 2;  // 2.45 there
  EXPECT_EQ(one.left(OneJoint::motion(1, 100)), "none");
}

TEST(MotionCheck, NotANumberIsNoMotion) {
  const OneJoint one;
  Eigen::MatrixXd q = OneJoint::motion(1, 100);
  q(50, 0) = std::nan("");
  EXPECT_NE(one.left(q), "none");
}

}  // namespace
}  // namespace pvg
