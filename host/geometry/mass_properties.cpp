#include "host/geometry/mass_properties.hpp"

#include <Eigen/Geometry>

namespace pvg {

MassProperties mass_properties(const TriangleMesh& surface, double density) {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const Triangle& t : surface.triangles) {
    const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    const double v = a.dot(b.cross(c)) / 6;
    const Vec3 s = a + b + c;
    volume += v;
    first += v / 4 * s;
    second += v / 20 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Vec3 center = first / volume;
  const Eigen::Matrix3d about = second - volume * center * center.transpose();
  return {volume, density * volume, center, density * (about.trace() * Eigen::Matrix3d::Identity() - about)};
}

std::vector<double> moments_and_products(const Eigen::Matrix3d& inertia) {
  std::vector<double> numbers = {inertia(0, 0), inertia(1, 1), inertia(2, 2)};
  if (!inertia.isApprox(Eigen::Matrix3d(inertia.diagonal().asDiagonal()), 1e-9))
    numbers.insert(numbers.end(), {inertia(0, 1), inertia(0, 2), inertia(1, 2)});
  return numbers;
}

}  // namespace pvg
