#include "host/robot/disturbance.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr double DAMPING = 1e-6;      // eps of J+, in m^2 and rad^2
constexpr double LEAST_SPEED = 1e-3;  // below it the tool has no way to be beside of [m/s]

double bump(double u) { return 64 * std::pow(u * (1 - u), 3); }

// Steps at which a push of n steps fits.
std::vector<std::size_t> possible_starts(const std::vector<bool>& may, std::size_t n) {
  std::vector<std::size_t> starts;
  std::size_t run = 0;  // steps up to here that may be disturbed
  for (std::size_t step = 0; step < may.size(); ++step) {
    run = may[step] ? run + 1 : 0;
    if (run >= n) starts.push_back(step + 1 - n);
  }
  return starts;
}

// The offset [m, base frame] without what points along the tool's way at the step.
Vec3 beside_the_way(const PushedRobot& robot, const Eigen::MatrixXd& q, std::size_t step, double time_step,
                    const Vec3& offset) {
  const Eigen::Index n = Eigen::Index(robot.model.actuated.size()), last = q.rows() - 1;
  const auto place = [&](Eigen::Index row) {
    const VectorXd at = q.row(std::clamp<Eigen::Index>(row, 0, last)).head(n).transpose();
    return Vec3(tool_pose(robot.model, at, robot.tool_link, robot.flange_to_tool).translation());
  };
  const Vec3 way = place(Eigen::Index(step) + 1) - place(Eigen::Index(step) - 1);
  if (way.norm() < LEAST_SPEED * 2 * time_step) return offset;
  const Vec3 along = way.normalized();
  return offset - along * along.dot(offset);
}

void add_push(const PushedRobot& robot, const Eigen::MatrixXd& q, const PushAside& push, std::size_t first,
              std::size_t n, double time_step, Eigen::MatrixXd& shift) {
  const std::size_t middle = first + n / 2;
  const VectorXd at_middle = q.row(Eigen::Index(middle)).head(shift.cols()).transpose();
  const Mat3 tool = tool_pose(robot.model, at_middle, robot.tool_link, robot.flange_to_tool).linear();
  Eigen::Matrix<double, 6, 1> twist;
  twist << beside_the_way(robot, q, middle, time_step, tool * push.offset), tool * push.turn;
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::Index row = Eigen::Index(first + k);
    const VectorXd planned = q.row(row).head(shift.cols()).transpose();
    const Jacobian J = tool_jacobian(robot.model, planned, robot.tool_link, robot.flange_to_tool);
    Eigen::Matrix<double, 6, 6> damped = J * J.transpose();
    damped.diagonal().array() += DAMPING;
    shift.row(row) = bump(double(k + 1) / double(n)) * (J.transpose() * damped.ldlt().solve(twist)).transpose();
  }
}

void keep_limits(const RobotModel& model, const Eigen::MatrixXd& q, Eigen::MatrixXd& shift) {
  for (Eigen::Index c = 0; c < shift.cols(); ++c) {
    const RobotJoint& joint = model.joints[std::size_t(model.actuated[std::size_t(c)])];
    if (joint.lower == 0 && joint.upper == 0) continue;
    for (Eigen::Index row = 0; row < shift.rows(); ++row) {
      const double low = std::min(0.0, joint.lower - q(row, c)), high = std::max(0.0, joint.upper - q(row, c));
      shift(row, c) = std::clamp(shift(row, c), low, high);
    }
  }
}

}  // namespace

Eigen::MatrixXd pushed_aside(const PushedRobot& robot, const Eigen::MatrixXd& q, const std::vector<bool>& may,
                             std::span<const PushAside> pushes, double time_step) {
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(q.rows(), Eigen::Index(robot.model.actuated.size()));
  std::size_t free_from = 0;
  for (std::size_t k = 0; k < pushes.size(); ++k) {
    const auto n = std::size_t(std::max(2.0, std::round(pushes[k].duration / time_step)));
    const std::vector<std::size_t> starts = possible_starts(may, n);
    if (starts.empty())
      throw UsageError(
          fmt::format("a disturbance of {:g} s fits nowhere into the motion; give it less `duration`, or "
                      "more elements in `during`",
                      pushes[k].duration));
    const double place = (double(k) + pushes[k].start) / double(pushes.size()) * double(starts.size());
    const std::size_t wanted = starts[std::min(std::size_t(place), starts.size() - 1)];
    const auto first = std::lower_bound(starts.begin(), starts.end(), std::max(wanted, free_from));
    if (first == starts.end()) continue;
    add_push(robot, q, pushes[k], *first, n, time_step, shift);
    free_from = *first + n;
  }
  keep_limits(robot.model, q, shift);
  return shift;
}

}  // namespace pvg
