// Does a written trajectory keep a robot's limits at every sample? The samples are all that the arm's interface sees,
// so the differences between them are what it judges: velocity, also against the position-dependent bounds,
// acceleration and jerk.
#pragma once
#include <optional>
#include <string>

#include "host/robot/kinematics.hpp"

namespace pvg {

// Nothing, or a sentence about the first sample that leaves a limit. q: [n_steps, >= n_actuated, rad], of which the
// first columns are the robot's; row k is reached at (k + 1) h from rest at q_start, and the robot rests after the last
// row. Limits that the URDF leaves open are not checked.
std::optional<std::string> limit_left(const RobotModel& model, const VectorXd& q_start, const Eigen::MatrixXd& q,
                                      double time_step);

}  // namespace pvg
