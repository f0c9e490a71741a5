#include "host/geometry/inside.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pvg {
namespace {

// nearest to p
Vec3 point_of_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a;
  const double length = edge.squaredNorm(), share = length > 0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0;
  return a + share * edge;
}

Vec3 nearer(const Vec3& p, const Vec3& a, const Vec3& b) {
  return (b - p).squaredNorm() < (a - p).squaredNorm() ? b : a;
}

Vec3 point_of_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const auto is_within = [&](const Vec3& from, const Vec3& to) { return normal.cross(to - from).dot(p - from) >= 0; };
  if (normal.squaredNorm() > 0 && is_within(a, b) && is_within(b, c) && is_within(c, a))
    return p - (p - a).dot(normal) / normal.squaredNorm() * normal;
  return nearer(p, nearer(p, point_of_edge(p, a, b), point_of_edge(p, b, c)), point_of_edge(p, c, a));
}

Vec3 point_of_surface(const TriangleMesh& mesh, const Vec3& p) {
  Vec3 nearest = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (const Triangle& t : mesh.triangles)
    nearest = nearer(p, nearest, point_of_triangle(p, mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
  return nearest;
}

bool is_inside(const TriangleMesh& mesh, const Vec3& p) { return winding_number(mesh.points, mesh.triangles, p) > 0.5; }

// What passes_through() has seen of its way.
class Passage {
 public:
  Passage(const TriangleMesh& mesh, double depth) : mesh_(mesh), depth_(depth) {
    for (const Vec3& p : mesh.points) bounds_.extend(p);
  }

  // Whether it has passed through once it is at p, which is near to the place before it.
  bool is_through_at(const Vec3& p) {
    if ((p - last_).norm() < clearance_) return false;
    last_ = p;
    const Vec3 surface = point_of_surface(mesh_, p), out = surface - p;
    if (!bounds_.contains(p) || !is_inside(mesh_, p)) {
      clearance_ = out.norm();
      enters_ = true;
      const bool leaves = n_inside_ > 0;
      n_inside_ = 0;
      return leaves && way_out_.dot(way_in_) < -0.5 && way_in_.dot(entered_ - left_) > depth_;
    }
    clearance_ = 0;
    if (out.norm() > depth_) return enters_;
    enters_ = true;
    if (n_inside_++ == 0) entered_ = surface, way_in_ = out.normalized();
    left_ = surface, way_out_ = out.normalized();
    return false;
  }

 private:
  const TriangleMesh& mesh_;
  double depth_;
  Eigen::AlignedBox3d bounds_;
  Vec3 last_ = Vec3::Constant(std::numeric_limits<double>::infinity());
  double clearance_ = 0;  // nothing of the surface is nearer to last_, which is outside; else 0
  bool enters_ = false;   // it has been outside, or not deep inside
  int n_inside_ = 0;
  Vec3 entered_, left_;    // points of the surface, nearest to the first and to the last place inside
  Vec3 way_in_, way_out_;  // from those places to them, unit
};

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
  return is_inside(mesh, p) ? (point_of_surface(mesh, p) - p).norm() : 0;
}

bool passes_through(const TriangleMesh& mesh, std::span<const Vec3> way, double depth) {
  Passage passage(mesh, depth);
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Vec3 step = way[i + 1] - way[i];
    const int n = std::max(1, int(std::ceil(step.norm() / (0.4 * depth))));
    for (int k = i == 0 ? 0 : 1; k <= n; ++k)
      if (passage.is_through_at(way[i] + double(k) / n * step)) return true;
  }
  return false;
}

}  // namespace pvg
