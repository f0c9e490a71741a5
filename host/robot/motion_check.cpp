#include "host/robot/motion_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/robot/joint_path.hpp"

namespace pvg {
namespace {

constexpr double ROUNDING = 1e-9;  // share of a limit

std::string sentence(const RobotJoint& joint, double time, const char* what, double value, double limit) {
  return fmt::format("{} at {:.3f} s: its {} is {:.6g}, the limit is {:.6g}", joint.name, time, what, value, limit);
}

}  // namespace

std::optional<std::string> limit_left(const RobotModel& model, const VectorXd& q_start, const Eigen::MatrixXd& q,
                                      double time_step) {
  const Eigen::Index n = q.rows();
  for (std::size_t j = 0; j < model.actuated.size(); ++j) {
    const RobotJoint& joint = model.joints[std::size_t(model.actuated[j])];
    const auto column = Eigen::Index(j);
    const auto at = [&](Eigen::Index k) { return k < 0 ? q_start[column] : q(std::min(k, n - 1), column); };
    for (Eigen::Index k = 0; k < n + 3; ++k) {
      const double h = time_step, time = double(k + 1) * h;
      const double velocity = (at(k) - at(k - 1)) / h;
      const double acceleration = (at(k) - 2 * at(k - 1) + at(k - 2)) / (h * h);
      const double jerk = (at(k) - 3 * at(k - 1) + 3 * at(k - 2) - at(k - 3)) / (h * h * h);
      const auto is_over = [&](double value, double limit) {
        return limit > 0 && !(std::abs(value) <= limit * (1 + ROUNDING));
      };
      const bool has_ends = joint.lower != 0 || joint.upper != 0;
      if (has_ends && !(at(k) >= joint.lower && at(k) <= joint.upper))
        return sentence(joint, time, "position", at(k), at(k) < joint.lower ? joint.lower : joint.upper);
      // the mean velocity between two samples is at most the larger of the bounds at both
      const bool is_forward = velocity > 0;
      const double bound =
          std::max(velocity_limit(joint, at(k - 1), is_forward), velocity_limit(joint, at(k), is_forward));
      if (joint.velocity > 0 && !(std::abs(velocity) <= bound * (1 + ROUNDING)))
        return sentence(joint, time, "velocity", velocity, bound);
      if (is_over(acceleration, joint.acceleration))
        return sentence(joint, time, "acceleration", acceleration, joint.acceleration);
      if (is_over(jerk, joint.jerk)) return sentence(joint, time, "jerk", jerk, joint.jerk);
    }
  }
  return std::nullopt;
}

}  // namespace pvg
