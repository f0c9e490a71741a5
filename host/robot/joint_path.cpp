#include "host/robot/joint_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pvg {
namespace {

constexpr int SAMPLES = 1000;       // of u, at which the limits are checked
constexpr double KEPT_BACK = 1e-3;  // share of every limit that is left unused (libfranka takes off as much)

// dq/ds at an end, from the first or last four knots (third order); fewer knots: the plain difference
Eigen::RowVectorXd end_slope(const Eigen::MatrixXd& knots, bool is_last) {
  const auto n = knots.rows();
  const double intervals = double(n - 1);
  const auto k = [&](Eigen::Index i) { return knots.row(is_last ? n - 1 - i : i); };
  const double sign = is_last ? -1 : 1;
  if (n < 4) return sign * intervals * (k(1) - k(0));
  return sign * intervals * (-11 * k(0) + 18 * k(1) - 9 * k(2) + 2 * k(3)) / 6;
}

}  // namespace

Smoothstep smoothstep(double u) {
  return {u * u * u * (10 + u * (-15 + 6 * u)), 30 * u * u * (1 - u) * (1 - u), 60 * u * (1 - u) * (1 - 2 * u),
          60 * (1 + u * (-6 + 6 * u))};
}

// The slopes m of a C2 spline with interval h satisfy m[i-1] + 4 m[i] + m[i+1] = 3 (q[i+1] - q[i-1]) / h.
JointPath::JointPath(const Eigen::MatrixXd& knots) : knots_(knots), slopes_(knots.rows(), knots.cols()) {
  const auto n = knots.rows();
  slopes_.row(0) = end_slope(knots, false);
  slopes_.row(n - 1) = end_slope(knots, true);
  // Thomas' algorithm; the diagonal dominates, so that no pivot is needed
  Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(n, 4);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    slopes_.row(i) = 3 * double(n - 1) * (knots.row(i + 1) - knots.row(i - 1));
    if (i == 1) {
      slopes_.row(i) -= slopes_.row(0);
    } else {
      slopes_.row(i) -= slopes_.row(i - 1) / diagonal[i - 1];
      diagonal[i] -= 1 / diagonal[i - 1];
    }
  }
  for (Eigen::Index i = n - 2; i >= 1; --i) slopes_.row(i) = (slopes_.row(i) - slopes_.row(i + 1)) / diagonal[i];
}

JointPath::Point JointPath::at(double s) const {
  const double n = double(knots_.rows() - 1);
  const auto i = std::clamp(Eigen::Index(std::floor(s * n)), Eigen::Index(0), knots_.rows() - 2);
  const double t = s * n - double(i);
  const Eigen::VectorXd q0 = knots_.row(i), q1 = knots_.row(i + 1), m0 = slopes_.row(i) / n,
                        m1 = slopes_.row(i + 1) / n;
  // q = q0 + m0 t + b t^2 + a t^3 within the interval
  const Eigen::VectorXd a = 2 * (q0 - q1) + m0 + m1, b = 3 * (q1 - q0) - 2 * m0 - m1;
  return {q0 + t * (m0 + t * (b + t * a)), n * (m0 + t * (2 * b + 3 * t * a)), n * n * (2 * b + 6 * t * a),
          n * n * n * 6 * a};
}

double velocity_limit(const RobotJoint& joint, double q, bool is_forward) {
  if (!joint.envelope) return joint.velocity;
  const VelocityEnvelope& e = *joint.envelope;
  const double room = is_forward ? e.upper - q : e.lower + q;
  return std::min(joint.velocity, std::max(0.0, -e.offset + std::sqrt(std::max(0.0, e.slope * room))));
}

double shortest_duration(const JointPath& path, const std::vector<RobotJoint>& joints, const MotionLimits& limits) {
  double duration = 0;
  for (int k = 0; k <= SAMPLES; ++k) {
    const Smoothstep s = smoothstep(double(k) / SAMPLES);
    const JointPath::Point p = path.at(s.value);
    const Eigen::VectorXd velocity = p.first * s.first;  // times T
    const Eigen::VectorXd acceleration = p.second * s.first * s.first + p.first * s.second;
    const Eigen::VectorXd jerk =
        p.third * s.first * s.first * s.first + 3 * p.second * s.first * s.second + p.first * s.third;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const double a = joints[i].acceleration > 0 ? joints[i].acceleration : limits.default_acceleration;
      const double j = joints[i].jerk > 0 ? joints[i].jerk : limits.default_jerk;
      const double v = limits.share * velocity_limit(joints[i], p.q[i], velocity[i] > 0);
      if (std::abs(velocity[i]) > 1e-12) duration = std::max(duration, std::abs(velocity[i]) / v);
      duration = std::max(duration, std::sqrt(std::abs(acceleration[i]) / (limits.share * a)));
      duration = std::max(duration, std::cbrt(std::abs(jerk[i]) / j));
    }
  }
  return duration * (1 + KEPT_BACK);
}

}  // namespace pvg
