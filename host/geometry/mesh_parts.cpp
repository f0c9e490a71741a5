#include "host/geometry/mesh_parts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "host/geometry/inside.hpp"
#include "host/geometry/mesh_checks.hpp"

namespace pvg {
namespace {

constexpr double BELOW = 1e-4;             // depth of a point below its triangle, in sizes of the mesh
constexpr std::size_t MOST_SAMPLES = 400;  // points per part

struct Part {
  std::vector<Triangle> triangles;
  Eigen::AlignedBox3d box;
};

std::vector<Part> parts_of(const TriangleMesh& mesh) {
  const std::vector<int> component = triangle_components(mesh);
  std::vector<Part> parts;
  for (std::size_t t = 0; t < component.size(); ++t) {
    const std::size_t part = std::size_t(component[t]);
    if (part >= parts.size()) parts.resize(part + 1);
    parts[part].triangles.push_back(mesh.triangles[t]);
    for (const std::uint32_t corner : mesh.triangles[t]) parts[part].box.extend(mesh.points[corner]);
  }
  return parts;
}

bool reaches_into(const TriangleMesh& mesh, const Part& part, const Part& other, double depth) {
  const std::size_t every = std::max<std::size_t>(1, part.triangles.size() / MOST_SAMPLES);
  for (std::size_t i = 0; i < part.triangles.size(); i += every) {
    const auto& [a, b, c] = part.triangles[i];
    const Vec3 normal = (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]);
    if (!(normal.norm() > 0)) continue;
    const Vec3 below = (mesh.points[a] + mesh.points[b] + mesh.points[c]) / 3 - depth * normal.normalized();
    if (!other.box.contains(below)) continue;
    if (winding_number(mesh.points, other.triangles, below) > 0.5) return true;
  }
  return false;
}

}  // namespace

bool has_overlapping_parts(const TriangleMesh& mesh) {
  const std::vector<Part> parts = parts_of(mesh);
  if (parts.size() < 2) return false;
  Eigen::AlignedBox3d whole;
  for (const Part& part : parts) whole.extend(part.box);
  const double depth = BELOW * whole.diagonal().norm();
  for (const Part& part : parts)
    for (const Part& other : parts)
      if (&part != &other && part.box.intersects(other.box) && reaches_into(mesh, part, other, depth)) return true;
  return false;
}

}  // namespace pvg
