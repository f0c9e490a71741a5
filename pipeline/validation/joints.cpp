// Joints and drives against the kinematics that their axes give and the loads that they carry.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pipeline/validation/cases.hpp"

namespace pvg {
namespace {

WorldState last_state(const Validation& v, const SceneRun& run) {
  WorldState last;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    last = state;
    return true;
  });
  return last;
}

Pose moved(const Vec3& by) {
  Pose pose = Pose::Identity();
  pose.translation() = by;
  return pose;
}

Pose turned(double angle, const Vec3& axis) { return Pose(Eigen::AngleAxisd(angle, axis)); }

// largest distance over the corners of a body that is a box of 0.1 m [m]
double apart(const AffineMap& simulated, const Pose& expected) {
  double worst = 0;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner = 0.05 * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    worst = std::max(worst, (simulated.leftCols<3>() * corner + simulated.col(3) - expected * corner).norm());
  }
  return worst;
}

}  // namespace

void validate_joint_signs(Validation& v) {
  const SceneRun run = v.load("joint_signs");
  const Scene& scene = run.scene;
  std::vector<double> distance;  // of the ball joint's body from its joint
  WorldState last;
  Vec3 turn = Vec3::Zero();  // of that body in the first step
  v.run(run, [&](const WorldState& state, const StepReport&) {
    const AffineMap& map = state.rigid[rigid_index(scene, "ball_arm")];
    distance.push_back((map.col(3) + map.leftCols<3>() * Vec3(0, 0, -0.2) - Vec3(0, 1, 0)).norm());
    const Eigen::AngleAxisd first(Mat3(map.leftCols<3>()));
    if (distance.size() == 1) turn = first.angle() * first.axis();
    last = state;
    return true;
  });
  // the way each joint moves its child, written down by hand: right-handed about its axis, along its axis
  const Pose turret = moved({0, 0, 0.2}) * turned(0.7, Vec3::UnitZ());
  const Pose slide = turret * moved({0.2, 0, 0}) * moved(0.05 * Vec3(0, 0.6, 0.8));
  const Pose bracket = slide * moved({0.2, 0, 0}) * turned(0.3, Vec3::UnitX());
  // the hinge stands in the middle between bracket and arm, whose turn at the start is taken back
  const Pose arm =
      bracket * moved({0.1, 0, 0}) * turned(0.4, -Vec3::UnitY()) * turned(-0.3, Vec3::UnitX()) * moved({0.1, 0, 0});
  const std::string source = "forward kinematics by hand";
  const auto check = [&](const std::string& quantity, const std::string& body, const Pose& expected) {
    v.check_at_most(quantity, "m", apart(last.rigid[rigid_index(scene, body)], expected), 1e-6, source);
  };
  check("revolute, +0.7 rad about z: largest error of a corner", "turret", turret);
  check("prismatic, +50 mm along (0, 0.6, 0.8)", "slide", slide);
  check("fixed", "bracket", bracket);
  check("revolute, +0.4 rad about -y, at the chain's end", "arm", arm);
  v.check_at_most("spherical: distance of the anchors, the worst", "m",
                  *std::max_element(distance.begin(), distance.end()), 1e-6, source);
  v.check("spherical: angle between turn and angular velocity", "rad", 0,
          std::acos(std::min(1.0, turn.normalized().dot(Vec3(0.5, -0.3, 0.8).normalized()))), 0.01, "right-handed");
}

void validate_drive(Validation& v) {
  const SceneRun run = v.load("drive");
  const WorldState last = last_state(v, run);
  const double weight = 9.80665;
  double q = 0;  // k q = m g l cos q; the arm points along x and sinks with positive turns about y
  for (int i = 0; i < 50; ++i) q = weight * 0.2 / 200 * std::cos(q);
  v.check_relative("revolute: deflection", "rad", q, last.joint_position[0], 1e-3, "torque / stiffness");
  v.check_relative("revolute: torque of the drive", "N m", -200 * q, last.joint_effort[0], 1e-3, "m g l cos q");
  v.check_relative("prismatic: deflection", "m", -weight / 1000, last.joint_position[1], 1e-3, "force / stiffness");
}

// The rocker's angle of a four-bar linkage: its end lies where circles about the crank's end and the rocker's hinge
// meet.
void validate_four_bar(Validation& v) {
  const SceneRun run = v.load("four_bar");
  const WorldState last = last_state(v, run);
  const double crank = 0.1, coupler = 0.25, rocker = 0.2, ground = 0.3, start = 1;
  const auto rocker_angle = [&](double t) {
    const Eigen::Vector2d from(crank * std::cos(t), crank * std::sin(t)), to = Eigen::Vector2d(ground, 0) - from;
    const double along = (to.squaredNorm() + coupler * coupler - rocker * rocker) / (2 * to.norm());
    const double across = std::sqrt(coupler * coupler - along * along);
    const Eigen::Vector2d end = from + (along * to + across * Eigen::Vector2d(-to.y(), to.x())) / to.norm();
    return std::atan2(end.y(), end.x() - ground);
  };
  v.check("angle of the crank", "rad", 0.5, last.joint_position[0], 1e-4, "the drive's target");
  v.check("angle that the rocker turned by", "rad", rocker_angle(start + last.joint_position[0]) - rocker_angle(start),
          last.joint_position[3], 1e-6, "two circles that meet");
}

}  // namespace pvg
