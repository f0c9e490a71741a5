// Inverse kinematics by damped least squares (Nakamura & Hanafusa 1986): with the pose error e (6) and the Jacobian J,
//   dq = J^T (J J^T + lambda I)^-1 e + (I - J^+ J) g (posture - q),   lambda = min(0.1, 0.1 |e|^2 + 1e-9),
// no joint by more than 0.5, then held within the limits.
#include "host/robot/kinematics.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr double LARGEST_STEP = 0.5;             // of a joint per iteration [rad or m]
constexpr double DIFFERENT = 1e-3;               // two solutions further apart than this are two
constexpr double FREE_RANGE = std::numbers::pi;  // random start of a joint without ends [rad]

struct Range {
  double lower, upper;
};

Range range(const RobotJoint& joint, double margin) {
  const bool has_ends = joint.lower != 0 || joint.upper != 0;
  if (!has_ends) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const double kept = std::min(margin, (joint.upper - joint.lower) / 2);
  return {joint.lower + kept, joint.upper - kept};
}

VectorXd hold_within(const RobotModel& model, VectorXd q, double margin) {
  for (std::size_t i = 0; i < model.actuated.size(); ++i) {
    const Range r = range(model.joints[model.actuated[i]], margin);
    q[i] = std::clamp(q[i], r.lower, r.upper);
  }
  return q;
}

// our own, because the standard leaves std::uniform_real_distribution to the library
double uniform(std::mt19937_64& random) { return double(random() >> 11) * 0x1p-53; }

VectorXd random_configuration(const RobotModel& model, double margin, std::mt19937_64& random) {
  VectorXd q(model.actuated.size());
  for (std::size_t i = 0; i < model.actuated.size(); ++i) {
    Range r = range(model.joints[model.actuated[i]], margin);
    if (!std::isfinite(r.upper)) r = {-FREE_RANGE, FREE_RANGE};
    q[i] = r.lower + (r.upper - r.lower) * uniform(random);
  }
  return q;
}

void check_size(const RobotModel& model, const VectorXd& q) {
  if (std::size_t(q.size()) != model.actuated.size())
    throw UsageError("robot '" + model.name + "' has " + counted(model.actuated.size(), "moving joint") +
                     " but was given " + counted(q.size(), "position") + "; give one for each");
}

}  // namespace

Pose joint_motion(const RobotJoint& joint, double q) {
  Pose motion = Pose::Identity();
  if (joint.type == Joint::Type::revolute) motion.linear() = Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  if (joint.type == Joint::Type::prismatic) motion.translation() = q * joint.axis;
  return motion;
}

std::vector<Pose> link_poses(const RobotModel& model, const VectorXd& q, const Pose& base) {
  check_size(model, q);
  std::vector<Pose> poses(model.links.size());
  poses[0] = base;
  int next = 0;
  for (const RobotJoint& joint : model.joints) {
    poses[joint.child] = poses[joint.parent] * joint.origin;
    if (joint.type != Joint::Type::fixed) poses[joint.child] = poses[joint.child] * joint_motion(joint, q[next++]);
  }
  return poses;
}

Pose tool_pose(const RobotModel& model, const VectorXd& q, int link, const Pose& tool) {
  return link_poses(model, q)[link] * tool;
}

Jacobian tool_jacobian(const RobotModel& model, const VectorXd& q, int link, const Pose& tool) {
  const std::vector<Pose> poses = link_poses(model, q);
  const Vec3 origin = poses[link] * tool.translation();
  Jacobian jacobian = Jacobian::Zero(6, q.size());
  // walk from the link to the base: only those joints move it
  for (int at = link; at > 0; at = model.joints[at - 1].parent) {
    const RobotJoint& joint = model.joints[at - 1];
    if (joint.type == Joint::Type::fixed) continue;
    const auto column = std::find(model.actuated.begin(), model.actuated.end(), at - 1) - model.actuated.begin();
    const Vec3 axis = poses[at].linear() * joint.axis;
    if (joint.type == Joint::Type::prismatic) {
      jacobian.col(column).head<3>() = axis;
    } else {
      jacobian.col(column).head<3>() = axis.cross(origin - poses[at].translation());
      jacobian.col(column).tail<3>() = axis;
    }
  }
  return jacobian;
}

Eigen::Matrix<double, 6, 1> pose_difference(const Pose& from, const Pose& to) {
  Eigen::Matrix<double, 6, 1> difference;
  difference.head<3>() = to.translation() - from.translation();
  // by the quaternion, which keeps all digits of small angles
  Eigen::Quaterniond turn(Mat3(to.linear() * from.linear().transpose()));
  if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  const double scale = sine < 1e-12 ? 2 : 2 * std::atan2(sine, turn.w()) / sine;
  difference.tail<3>() = scale * turn.vec();
  return difference;
}

std::optional<VectorXd> follow_pose(const RobotModel& model, int link, const Pose& tool, const Pose& target,
                                    const VectorXd& q_start, const InverseKinematics& settings) {
  check_size(model, q_start);
  VectorXd q = hold_within(model, q_start, settings.margin);
  for (int iteration = 0; iteration < settings.max_iterations; ++iteration) {
    const Eigen::Matrix<double, 6, 1> error = pose_difference(tool_pose(model, q, link, tool), target);
    const double size = error.norm();
    if (size < settings.tolerance) return q;
    const Jacobian J = tool_jacobian(model, q, link, tool);
    const double damping = std::min(0.1, 0.1 * size * size + 1e-9);
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> factor(J * J.transpose() +
                                                          damping * Eigen::Matrix<double, 6, 6>::Identity());
    VectorXd dq = J.transpose() * factor.solve(error);
    if (settings.posture.size() == q.size() && settings.posture_gain > 0) {
      const VectorXd pull = settings.posture_gain * (settings.posture - q);
      dq += pull - J.transpose() * factor.solve(J * pull);
    }
    const double largest = dq.cwiseAbs().maxCoeff();
    if (largest > LARGEST_STEP) dq *= LARGEST_STEP / largest;
    q = hold_within(model, q + dq, settings.margin);
  }
  return std::nullopt;
}

std::vector<VectorXd> reach_pose(const RobotModel& model, int link, const Pose& tool, const Pose& target,
                                 const VectorXd& q_start, const InverseKinematics& settings) {
  std::mt19937_64 random(settings.seed);
  std::vector<VectorXd> solutions;
  for (int attempt = 0; attempt < settings.max_tries && int(solutions.size()) < settings.n_solutions; ++attempt) {
    const VectorXd start = attempt == 0 ? q_start : random_configuration(model, settings.margin, random);
    const std::optional<VectorXd> q = follow_pose(model, link, tool, target, start, settings);
    const auto is_same = [&](const VectorXd& other) { return (other - *q).cwiseAbs().maxCoeff() < DIFFERENT; };
    if (q && std::none_of(solutions.begin(), solutions.end(), is_same)) solutions.push_back(*q);
  }
  std::stable_sort(solutions.begin(), solutions.end(), [&](const VectorXd& a, const VectorXd& b) {
    return (a - q_start).squaredNorm() < (b - q_start).squaredNorm();
  });
  return solutions;
}

}  // namespace pvg
