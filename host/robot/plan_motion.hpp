// Motion elements -> the reference q_ref of every step. Each element is a path in the joint space: a straight line, the
// inverse kinematics along a way of the tool (a line, an arc, a smooth curve through given poses), or a way searched
// around obstacles. It is run through from rest to rest by
//   s(u) = 10 u^3 - 15 u^4 + 6 u^5,   u = t / duration,
// with the shortest duration, a whole number of steps, that keeps every joint inside its limits of velocity (also the
// position-dependent one), acceleration and jerk. Elements that go on together take the time of the slowest. Blended
// elements do not rest between (motion_timing.hpp).
//
// Of the configurations that reach a target the nearest to the `posture` comes first, without one the nearest to where
// the arm is. Others are tried where the rest of the motion cannot be planned from it. So one posture keeps the motions
// of all starts in one branch of the inverse kinematics, from which ways of the tool go on.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/model/motion.hpp"
#include "host/robot/kinematics.hpp"

namespace pvg {

// A collision-free way between two configurations, as knots [n, n_actuated]; nothing: none was found.
using PlanPath = std::function<std::optional<Eigen::MatrixXd>(const VectorXd& from, const VectorXd& to)>;

// One robot.
struct MotionSetup {
  Pose base = Pose::Identity();              // of the robot's base link, to world
  int tool_link = -1;                        // link that carries the tool: the flange
  Pose flange_to_tool = Pose::Identity();    // tool frame in that link's frame
  VectorXd q_start = {};                     // [n_actuated, rad]
  VectorXd posture = {};                     // [n_actuated, rad] whose branch is preferred; empty: where it is
  int n_gripper_joints = 0;                  // they follow the arm's joints in q_ref and all move alike
  double gripper_start = 0;                  // their position [m]
  double gripper_speed = 0.05;               // limit [m/s]
  double gripper_acceleration = 0.5;         // limit [m/s^2]
  std::map<std::string, Pose> objects = {};  // frames that elements refer to, to world, at the start
  double time_step = 0.01;                   // h [s]
  double rest = 0.1;                         // stand-still after every element [s]
  double default_acceleration = 10;          // of joints whose URDF gives no limit [rad/s^2]
  double default_jerk = 5000;                // likewise [rad/s^3]
  PlanPath plan_path = {};                   // for elements that avoid obstacles; empty: they are refused
};

struct JointTrajectory {
  double time_step = 0;      // h [s]
  Eigen::MatrixXd q;         // [n_steps, n_actuated + n_gripper_joints]: row k is reached at (k + 1) h
  std::vector<int> element;  // [n_steps] which element of the list the step belongs to, of several together the first
};

struct PlannedRobot {
  const RobotModel& model;
  const MotionSetup& setup;
};

// Throws a UsageError that names the element if a target cannot be reached or a straight line leaves the joint limits.
JointTrajectory plan_motion(const RobotModel& model, const MotionSetup& setup, std::span<const MotionElement> elements);

// Several robots at one time step; -> one trajectory each, of equal length. MotionElement::robot counts them.
std::vector<JointTrajectory> plan_motion(std::span<const PlannedRobot> robots, std::span<const MotionElement> elements);

}  // namespace pvg
