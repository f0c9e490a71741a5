#include "host/geometry/inside.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pvg {
namespace {

double squared_distance_to_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a;
  const double length = edge.squaredNorm(), share = length > 0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0;
  return (p - a - share * edge).squaredNorm();
}

double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const auto is_within = [&](const Vec3& from, const Vec3& to) { return normal.cross(to - from).dot(p - from) >= 0; };
  if (normal.squaredNorm() > 0 && is_within(a, b) && is_within(b, c) && is_within(c, a)) {
    const double height = (p - a).dot(normal) / normal.norm();
    return height * height;
  }
  return std::min(
      {squared_distance_to_edge(p, a, b), squared_distance_to_edge(p, b, c), squared_distance_to_edge(p, c, a)});
}

}  // namespace

double winding_number(std::span<const Vec3> points, std::span<const Triangle> triangles, const Vec3& p) {
  double angle = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = points[t[0]] - p, b = points[t[1]] - p, c = points[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

double depth_inside(const TriangleMesh& mesh, const Vec3& p) {
  if (!(winding_number(mesh.points, mesh.triangles, p) > 0.5)) return 0;
  double least = std::numeric_limits<double>::max();
  for (const Triangle& t : mesh.triangles)
    least = std::min(least, squared_distance(p, mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
  return std::sqrt(least);
}

}  // namespace pvg
