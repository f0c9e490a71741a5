#include "host/geometry/primitive_visuals.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace pvg {
namespace {

// a flat polygon with points and normals of its own
void add_polygon(VisualMesh& mesh, const std::vector<Vec3f>& corners, const std::vector<Vec3f>& normals) {
  const auto start = std::uint32_t(mesh.points.size());
  mesh.points.insert(mesh.points.end(), corners.begin(), corners.end());
  mesh.normals.insert(mesh.normals.end(), normals.begin(), normals.end());
  for (std::uint32_t k = 1; k + 1 < corners.size(); ++k) mesh.triangles.push_back({start, start + k, start + k + 1});
}

Vec3f circle(int i, int segments) {
  const double angle = 2 * std::numbers::pi * (i % segments) / segments;
  return Vec3f(float(std::cos(angle)), float(std::sin(angle)), 0);
}

}  // namespace

VisualMesh box_visual(const Vec3& size) {
  VisualMesh mesh;
  const Vec3f half = size.cast<float>() / 2;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const Vec3f n = side * Vec3f::Unit(axis), u = Vec3f::Unit((axis + 1) % 3), v = n.cross(u);
      std::vector<Vec3f> corners;
      for (const Vec3f& corner : {Vec3f(n - u - v), Vec3f(n + u - v), Vec3f(n + u + v), Vec3f(n - u + v)})
        corners.push_back(corner.cwiseProduct(half));
      add_polygon(mesh, corners, std::vector<Vec3f>(4, n));
    }
  return mesh;
}

VisualMesh cylinder_visual(double radius, double length, int segments) {
  VisualMesh mesh;
  const Vec3f up(0, 0, float(length / 2));
  std::vector<Vec3f> top, bottom;
  for (int i = 0; i < segments; ++i) {
    const Vec3f n0 = circle(i, segments), n1 = circle(i + 1, segments);
    const Vec3f p0 = float(radius) * n0, p1 = float(radius) * n1;
    add_polygon(mesh, {p0 - up, p1 - up, p1 + up, p0 + up}, {n0, n1, n1, n0});
    top.push_back(p0 + up);
    bottom.insert(bottom.begin(), p0 - up);
  }
  add_polygon(mesh, top, std::vector<Vec3f>(top.size(), Vec3f::UnitZ()));
  add_polygon(mesh, bottom, std::vector<Vec3f>(bottom.size(), -Vec3f::UnitZ()));
  return mesh;
}

VisualMesh sphere_visual(double radius, int segments) {
  VisualMesh mesh;
  const int rings = segments / 2;
  const auto normal = [&](int i, int k) {
    if (k == 0 || k == rings) return Vec3f(0, 0, k == 0 ? -1 : 1);  // exactly one point at each pole
    const double latitude = std::numbers::pi * (double(k) / rings - 0.5);
    return Vec3f(float(std::cos(latitude)) * circle(i, segments) + Vec3f(0, 0, float(std::sin(latitude))));
  };
  for (int k = 0; k < rings; ++k)
    for (int i = 0; i < segments; ++i) {
      std::vector<Vec3f> normals = {normal(i, k), normal(i + 1, k), normal(i + 1, k + 1), normal(i, k + 1)};
      if (k == 0) normals.erase(normals.begin() + 1);
      if (k == rings - 1) normals.pop_back();
      std::vector<Vec3f> corners = normals;
      for (Vec3f& corner : corners) corner *= float(radius);
      add_polygon(mesh, corners, normals);
    }
  return mesh;
}

}  // namespace pvg
