// A path in the joint space and how fast it may be run through. The path q(s), s in [0, 1], is the cubic spline through
// evenly spaced knots, so that velocity and acceleration are continuous. It is run from rest to rest by
//   s(u) = 10 u^3 - 15 u^4 + 6 u^5,   u = t / T,
// whose first two derivatives vanish at both ends; then
//   dq/dt = q' s' / T,   d2q/dt2 = (q'' s'^2 + q' s'') / T^2,   d3q/dt3 = (q''' s'^3 + 3 q'' s' s'' + q' s''') / T^3.
#pragma once
#include <Eigen/Core>

#include "host/robot/robot.hpp"

namespace pvg {

// 10 u^3 - 15 u^4 + 6 u^5 and its derivatives by u
struct Smoothstep {
  double value, first, second, third;
};
Smoothstep smoothstep(double u);

class JointPath {
 public:
  explicit JointPath(const Eigen::MatrixXd& knots);  // [n_knots >= 2, n_joints]

  struct Point {
    Eigen::VectorXd q, first, second, third;  // position and derivatives by s  [n_joints]
  };
  Point at(double s) const;
  Eigen::VectorXd end() const { return knots_.row(knots_.rows() - 1); }

 private:
  Eigen::MatrixXd knots_, slopes_;  // slopes: dq/ds at the knots
};

// Velocity limit of a joint at position q, the position-dependent one included. is_forward: toward larger q.
double velocity_limit(const RobotJoint& joint, double q, bool is_forward);

struct MotionLimits {
  double share = 1;                  // of velocities and accelerations that is used, in (0, 1]
  double default_acceleration = 10;  // of joints whose URDF gives no limit [rad/s^2 or m/s^2]
  double default_jerk = 5000;        // likewise [rad/s^3 or m/s^3]
};

// Shortest time T [s] that keeps every joint of the path within its limits; infinite if one would have to move where
// its position-dependent limit is zero. joints: [n_joints], of the path's columns.
double shortest_duration(const JointPath& path, const std::vector<RobotJoint>& joints, const MotionLimits& limits);

}  // namespace pvg
