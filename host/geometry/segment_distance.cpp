#include "host/geometry/segment_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pvg {

namespace {

double squared_segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double ee = e.squaredNorm();
  const double s = ee > 0 ? std::clamp((p - a).dot(e) / ee, 0.0, 1.0) : 0.0;
  return (a + s * e - p).squaredNorm();
}

}  // namespace

double point_segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  return std::sqrt(squared_segment_distance(p, a, b));
}

// Of a triangle without area the normal, and with it the side, is rounding alone: the border is looked at in any case.
double point_triangle_distance(const Vec3& p, const Vec3& t0, const Vec3& t1, const Vec3& t2) {
  const double at_border = std::sqrt(std::min(
      {squared_segment_distance(p, t0, t1), squared_segment_distance(p, t1, t2), squared_segment_distance(p, t2, t0)}));
  const Vec3 normal = (t1 - t0).cross(t2 - t0);
  const auto side = [&](const Vec3& a, const Vec3& b) { return (b - a).cross(p - a).dot(normal); };
  const bool is_inside = side(t0, t1) > 0 && side(t1, t2) > 0 && side(t2, t0) > 0;
  return is_inside ? std::min(at_border, std::abs((p - t0).dot(normal)) / normal.norm()) : at_border;
}

double edge_edge_distance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const double at_ends = std::min({point_segment_distance(a0, b0, b1), point_segment_distance(a1, b0, b1),
                                   point_segment_distance(b0, a0, a1), point_segment_distance(b1, a0, a1)});
  const Vec3 e0 = a1 - a0, e1 = b1 - b0, r = b0 - a0, normal = e0.cross(e1);
  const double nn = normal.squaredNorm();
  if (!(nn > 0)) return at_ends;
  const double s = r.cross(e1).dot(normal) / nn, t = r.cross(e0).dot(normal) / nn;
  if (!(s > 0 && s < 1 && t > 0 && t < 1)) return at_ends;
  return std::min(at_ends, (a0 + s * e0 - b0 - t * e1).norm());
}

}  // namespace pvg
