// A push that takes a hand off its planned way and lets it come back, as a shift of the joints that the drives are
// told:
//   dq(t) = b(u) J+ (q) [d; phi],   b(u) = 64 u^3 (1 - u)^3,   u = (t - start) / duration in [0, 1]
// with the tool's Jacobian J, its damped pseudoinverse J+ = J^T (J J^T + eps I)^-1, the offset d of the tool at the
// middle of the push and its turn phi. What of d points along the tool's way is left out: the hand is beside its way,
// neither early nor late. b, its first and its second derivative vanish at both ends.
//
// Who demonstrates is recorded with the targets of the plan: from where the push has brought the hand, back to the way.
// (noise in what is done, none in what is recorded: Laskey et al., DART: noise injection for robust imitation learning,
// CoRL 2017)
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "host/robot/kinematics.hpp"

namespace pvg {

// A push of one robot's hand.
struct PushAside {
  double start = 0;            // where it begins, as a share of the steps at which it may, in [0, 1)
  double duration = 0;         // [s]
  Vec3 offset = Vec3::Zero();  // of the tool, in the tool's frame [m]
  Vec3 turn = Vec3::Zero();    // rotation vector, likewise [rad]
};

struct PushedRobot {
  const RobotModel& model;
  int tool_link = -1;
  Pose flange_to_tool = Pose::Identity();  // tool frame in that link's frame
};

// q: [n_steps, >= n_actuated] the plan, whose first columns are the arm's. may: [n_steps] whether a push may go on in
// the step. Push k of n begins in the k-th of n equal shares of the steps at which its duration fits; one that
// would begin before the last has ended begins then, or is left out where it no longer fits. A UsageError where none
// ever does.
// -> [n_steps, n_actuated, rad or m], within the joints' limits
Eigen::MatrixXd pushed_aside(const PushedRobot& robot, const Eigen::MatrixXd& q, const std::vector<bool>& may,
                             std::span<const PushAside> pushes, double time_step);

}  // namespace pvg
