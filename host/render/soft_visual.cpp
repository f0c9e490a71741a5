#include "host/render/soft_visual.hpp"

#include "host/base/error.hpp"

namespace pvg {
namespace {

// edges sharper than this stay sharp when the surface is subdivided: a finger's ribs keep their shape [rad]
constexpr double CREASE_ANGLE = 0.7;
constexpr int MAX_LEVELS = 4;  // each level has four times the triangles

Subdivision subdivide(const std::string& body, const std::vector<Vec3>& points, const std::vector<Triangle>& surface,
                      const Visual& visual) {
  if (visual.subdivision_levels < 0 || visual.subdivision_levels > MAX_LEVELS)
    throw UsageError("visual " + visual.name + ": subdivision_levels is " + std::to_string(visual.subdivision_levels) +
                     "; 0 to " + std::to_string(MAX_LEVELS));
  if (surface.empty()) throw UsageError("visual " + visual.name + ": soft body " + body + " has no surface");
  return subdivide_loop(points.size(), surface, visual.subdivision_levels, sharp_edges(points, surface, CREASE_ANGLE));
}

}  // namespace

SoftVisual::SoftVisual(Device& device, const std::string& body, const std::vector<Vec3>& points,
                       const std::vector<Triangle>& surface, const Visual& visual)
    : SoftVisual(device, points, subdivide(body, points, surface, visual)) {}

SoftVisual::SoftVisual(Device& device, const std::vector<Vec3>& points, const Subdivision& subdivision)
    : dual_mesh_(device, subdivision), refit_(device) {
  for (const Vec3& point : multiply(subdivision.weights, points)) mesh_.points.push_back(point.cast<float>());
  mesh_.normals.assign(mesh_.points.size(), Vec3f::UnitZ());  // the device computes them with every move
  mesh_.triangles = subdivision.triangles;
}

Box SoftVisual::follow(const std::vector<Vec3>& nodes, const MeshRange& range, DeviceScene& scene) {
  dual_mesh_.follow(nodes, scene.vertices, range.first_vertex);
  refit_(range, scene.triangles, scene.vertices, scene.trees.blocks, scene.trees.nodes);
  Box box;
  for (const Vec3& node : nodes) box.add(node.cast<float>());
  return box;
}

}  // namespace pvg
