// Forward and inverse kinematics of a RobotModel. Pure functions. q: [n_actuated, rad or m] in the order of
// RobotModel::actuated.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/robot/robot.hpp"

namespace pvg {

using Eigen::VectorXd;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Motion of a joint's child frame against the joint frame: turn about the axis by q, or shift along it.
Pose joint_motion(const RobotJoint& joint, double q);

// All link frames. base: the base link's pose.  -> [n_links]
std::vector<Pose> link_poses(const RobotModel& model, const VectorXd& q, const Pose& base = Pose::Identity());

// Pose of a frame fixed to a link. tool: that frame in the link's frame.
Pose tool_pose(const RobotModel& model, const VectorXd& q, int link, const Pose& tool = Pose::Identity());

// Rows 0..2: velocity of the tool frame's origin, rows 3..5: its angular velocity, both in the base frame, per dq/dt.
Jacobian tool_jacobian(const RobotModel& model, const VectorXd& q, int link, const Pose& tool = Pose::Identity());

// How far apart two poses are: [position difference, rotation vector that takes `from` to `to`]  [6, m and rad]
Eigen::Matrix<double, 6, 1> pose_difference(const Pose& from, const Pose& to);

struct InverseKinematics {
  double tolerance = 1e-7;  // norm of pose_difference at which a pose counts as reached
  int max_iterations = 60;  // per try
  int max_tries = 150;      // the first from the given start, the others from random configurations
  int n_solutions = 1;      // solutions to collect before the nearest to the start is taken
  double margin = 0;        // kept from the joints' ends [rad or m]
  std::uint64_t seed = 1;   // of the random configurations
  VectorXd posture = {};    // preferred configuration; empty: none
  double posture_gain = 0;  // share of the way to `posture` taken per iteration, within the null space
};

// Damped least squares inside the joint limits, started at q_start and tried once: continuous motion. Empty: not
// reached.
std::optional<VectorXd> follow_pose(const RobotModel& model, int link, const Pose& tool, const Pose& target,
                                    const VectorXd& q_start, const InverseKinematics& settings = {});

// The same with restarts: up to n_solutions different configurations, nearest to q_start first. Empty: none found.
std::vector<VectorXd> reach_pose(const RobotModel& model, int link, const Pose& tool, const Pose& target,
                                 const VectorXd& q_start, const InverseKinematics& settings = {});

}  // namespace pvg
