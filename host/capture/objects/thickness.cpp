// A ray o + t d meets the triangle (a, b, c) at t = f (e2 . q) with e1 = b - a, e2 = c - a, p = d x e2, q = (o - a) x
// e1 and f = 1 / (e1 . p), where u = f (o - a) . p and v = f d . q are in the triangle (Moeller and Trumbore 1997).
#include "host/capture/objects/thickness.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pvg {
namespace {

constexpr std::size_t MOST_THICKNESS_RAYS = 2000;
constexpr double ROUNDING = 1e-12;

// INFINITY: it is not met
double meets(const Vec3& o, const Vec3& d, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 e1 = b - a, e2 = c - a, p = d.cross(e2), s = o - a, q = s.cross(e1);
  const double f = 1 / e1.dot(p), u = f * s.dot(p), v = f * d.dot(q), t = f * e2.dot(q);
  // a ray through an edge meets one of its triangles at least
  return u >= -ROUNDING && v >= -ROUNDING && u + v <= 1 + ROUNDING && t > 0 ? t : INFINITY;
}

}  // namespace

std::vector<WallThickness> wall_thickness(const TriangleMesh& mesh) {
  std::vector<WallThickness> walls;
  const std::size_t n = mesh.triangles.size(), n_rays = std::min(n, MOST_THICKNESS_RAYS);
  for (std::size_t ray = 0; ray < n_rays; ++ray) {
    const std::size_t own = ray * n / n_rays;
    const auto corner = [&](std::size_t triangle, int k) -> const Vec3& {
      return mesh.points[mesh.triangles[triangle][std::size_t(k)]];
    };
    const Vec3 normal = (corner(own, 1) - corner(own, 0)).cross(corner(own, 2) - corner(own, 0));
    const Vec3 place = (corner(own, 0) + corner(own, 1) + corner(own, 2)) / 3;
    if (!(normal.norm() > 0)) continue;
    double nearest = INFINITY;
    for (std::size_t k = 0; k < n; ++k)
      if (k != own)
        nearest = std::min(nearest, meets(place, -normal.normalized(), corner(k, 0), corner(k, 1), corner(k, 2)));
    if (std::isfinite(nearest)) walls.push_back({nearest, 0.5 * normal.norm(), place});
  }
  std::sort(walls.begin(), walls.end(),
            [](const WallThickness& a, const WallThickness& b) { return a.thickness < b.thickness; });
  return walls;
}

double share_thinner(const std::vector<WallThickness>& walls, double than) {
  double thinner = 0, all = 0;
  for (const WallThickness& wall : walls) {
    all += wall.area;
    if (wall.thickness < than) thinner += wall.area;
  }
  return all > 0 ? thinner / all : 0;
}

}  // namespace pvg
