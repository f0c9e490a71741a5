#include "host/physics/step/extrapolation.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace pvg {
namespace {

constexpr double MOST_UNFORETOLD = 0.3;  // of the last change of velocity: beyond that the next one is not foretold

using Nodes = Eigen::Map<const Eigen::Matrix3Xd>;

Mat3 rotation(const Vec3& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Mat3::Identity();
}

// angular velocity of the rigid motion closest to the velocities v of points r about their centre
Vec3 angular_velocity(const Eigen::Matrix3Xd& r, const Eigen::Matrix3Xd& v) {
  Mat3 inertia = Mat3::Zero();
  Vec3 momentum = Vec3::Zero();
  for (int i = 0; i < r.cols(); ++i) {
    inertia += r.col(i).squaredNorm() * Mat3::Identity() - r.col(i) * r.col(i).transpose();
    momentum += r.col(i).cross(v.col(i));
  }
  return inertia.ldlt().solve(momentum);
}

void move_soft_body(const Nodes& x, const Nodes& v, double h, Eigen::Ref<Eigen::Matrix3Xd> motion) {
  const Vec3 centre = x.rowwise().mean(), drift = v.rowwise().mean();
  const Eigen::Matrix3Xd r = x.colwise() - centre, relative = v.colwise() - drift;
  const Vec3 omega = angular_velocity(r, relative);
  const Mat3 turn = rotation(h * omega) - Mat3::Identity();
  for (int i = 0; i < x.cols(); ++i)
    motion.col(i) = h * drift + turn * r.col(i) + h * (relative.col(i) - omega.cross(r.col(i)));
}

// nodes (p, a1, a2, a3): the axes turn, the centre of mass moves straight on
void move_affine_body(const Nodes& x, const Nodes& v, const Vec3& centre_of_mass, double h,
                      Eigen::Ref<Eigen::Matrix3Xd> motion) {
  const Vec3 omega = angular_velocity(x.rightCols<3>(), v.rightCols<3>());
  const Mat3 turn = rotation(h * omega) - Mat3::Identity();
  for (int k = 1; k < 4; ++k) motion.col(k) = turn * x.col(k) + h * (v.col(k) - omega.cross(x.col(k)));
  motion.col(0) = h * v.col(0) + (h * v.rightCols<3>() - motion.rightCols<3>()) * centre_of_mass;
}

}  // namespace

std::vector<double> extrapolated_velocities(const System& system, const std::vector<double>& v,
                                            const std::vector<double>& v_before,
                                            const std::vector<double>& v_two_before, std::span<const char> goes_on) {
  std::vector<double> extrapolated = v;
  for (const WorldRange& range : system.node_ranges) {
    if (!goes_on[range.world]) continue;
    const Eigen::Index first = 3 * Eigen::Index(range.begin), n = 3 * Eigen::Index(range.end - range.begin);
    const auto of_world = [&](const std::vector<double>& values) {
      return Eigen::Map<const Eigen::VectorXd>(values.data() + first, n);
    };
    const Eigen::VectorXd last = of_world(v) - of_world(v_before);
    const Eigen::VectorXd before = of_world(v_before) - of_world(v_two_before);
    const double foretold = last.dot(before);
    if (!(foretold > 0)) continue;
    const double part = foretold / std::max(last.squaredNorm(), before.squaredNorm());
    if ((last - part * before).norm() <= MOST_UNFORETOLD * last.norm())
      Eigen::Map<Eigen::VectorXd>(extrapolated.data() + first, n) += part * last;
  }
  return extrapolated;
}

std::vector<double> extrapolated_motion(const System& system, const std::vector<double>& x,
                                        const std::vector<double>& v, double h) {
  std::vector<double> motion(x.size(), 0);
  const auto at = [](const std::vector<double>& values, u32 first, std::size_t n) {
    return Nodes(&values[3 * first], 3, Eigen::Index(n));
  };
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    const PhysicalScene& scene = system.scenes[w];
    for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b) {
      const u32 first = system.soft_first_node[w][b];
      const std::size_t n = scene.soft_bodies[b].mesh.points.size();
      move_soft_body(at(x, first, n), at(v, first, n), h,
                     Eigen::Map<Eigen::Matrix3Xd>(&motion[3 * first], 3, Eigen::Index(n)));
    }
    for (std::size_t b = 0; b < scene.cloths.size(); ++b) {
      const u32 first = system.cloth_first_node[w][b];
      const std::size_t n = scene.cloths[b].mesh.points.size();
      move_soft_body(at(x, first, n), at(v, first, n), h,
                     Eigen::Map<Eigen::Matrix3Xd>(&motion[3 * first], 3, Eigen::Index(n)));
    }
    for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b) {
      if (scene.rigid_bodies[b].is_fixed) continue;
      const u32 first = system.rigid_first_node[w][b];
      move_affine_body(at(x, first, 4), at(v, first, 4), scene.rigid_bodies[b].center_of_mass, h,
                       Eigen::Map<Eigen::Matrix3Xd>(&motion[3 * first], 3, 4));
    }
  }
  for (std::size_t i = 0; i < motion.size(); ++i)
    if (system.node_is_fixed[i / 3]) motion[i] = 0;  // pinned points of a cloth that moves
  return motion;
}

}  // namespace pvg
