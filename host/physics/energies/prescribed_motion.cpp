#include "host/physics/energies/prescribed_motion.hpp"

#include <algorithm>

namespace pvg {
namespace {

constexpr double MASS = 1e6;           // [kg]
constexpr double LEAST_RADIUS = 1e-3;  // of gyration [m]

Pose between(const PathPoint& a, const PathPoint& b, double time) {
  const double share = (time - a.time) / (b.time - a.time);
  const Eigen::Quaterniond from(a.pose.linear()), to(b.pose.linear());
  Pose pose = Pose::Identity();
  pose.linear() = from.slerp(share, to).toRotationMatrix();
  pose.translation() = (1 - share) * a.pose.translation() + share * b.pose.translation();
  return pose;
}

}  // namespace

Pose prescribed_pose(const RigidBody& body, double time) {
  if (body.path.empty()) {
    Pose pose = body.pose;
    pose.translation() += time * body.velocity;
    const double turn = time * body.angular_velocity.norm();
    if (turn != 0) pose.linear() = Eigen::AngleAxisd(turn, body.angular_velocity.normalized()) * body.pose.linear();
    return pose;
  }
  const auto after = std::upper_bound(body.path.begin(), body.path.end(), time,
                                      [](double t, const PathPoint& point) { return t < point.time; });
  if (after == body.path.begin()) return body.path.front().pose;
  if (after == body.path.end()) return body.path.back().pose;
  return between(*(after - 1), *after, time);
}

Eigen::Matrix4d prescribed_mass_matrix(const RigidBody& body) {
  double radius = LEAST_RADIUS;
  for (const Vec3& point : body.collision.points) radius = std::max(radius, point.norm());
  Eigen::Matrix4d mass = MASS * radius * radius * Eigen::Matrix4d::Identity();
  mass(0, 0) = MASS;
  return mass;
}

bool has_prescribed_bodies(const System& system) {
  return std::any_of(system.scenes.begin(), system.scenes.end(), [](const PhysicalScene& scene) {
    return std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(),
                       [](const RigidBody& body) { return body.is_prescribed; });
  });
}

void write_prescribed(const System& system, std::size_t world, double time, std::vector<double>& nodes) {
  const PhysicalScene& scene = system.scenes[world];
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b) {
    if (!scene.rigid_bodies[b].is_prescribed) continue;
    const Pose pose = prescribed_pose(scene.rigid_bodies[b], time);
    double* node = &nodes[3 * system.rigid_first_node[world][b]];
    Eigen::Map<Vec3>{node} = pose.translation();
    Eigen::Map<Mat3>{node + 3} = pose.linear();  // columns: the axes
  }
}

}  // namespace pvg
