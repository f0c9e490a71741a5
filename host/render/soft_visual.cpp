#include "host/render/soft_visual.hpp"

#include "host/base/error.hpp"

namespace pvg {
namespace {

// edges sharper than this stay sharp when the surface is subdivided: a finger's ribs keep their shape [rad]
constexpr double CREASE_ANGLE = 0.7;
// a tree that costs so much more than when it was built is built anew
constexpr float BAD_COST = 1.4f;
constexpr int MAX_LEVELS = 4;  // each level has four times the triangles

}  // namespace

Subdivision visual_subdivision(const std::string& body, const std::vector<Vec3>& points,
                               const std::vector<Triangle>& surface, const Visual& visual) {
  if (visual.subdivision_levels < 0 || visual.subdivision_levels > MAX_LEVELS)
    throw UsageError("visual " + visual.name + ": subdivision_levels is " + std::to_string(visual.subdivision_levels) +
                     "; 0 to " + std::to_string(MAX_LEVELS));
  if (surface.empty()) throw UsageError("visual " + visual.name + ": soft body " + body + " has no surface");
  return subdivide_loop(points.size(), surface, visual.subdivision_levels, sharp_edges(points, surface, CREASE_ANGLE));
}

SoftVisual::SoftVisual(Device& device, const std::string& body, const std::vector<Vec3>& points,
                       const std::vector<Triangle>& surface, const Visual& visual)
    : SoftVisual(device, points, visual_subdivision(body, points, surface, visual)) {}

SoftVisual::SoftVisual(Device& device, const std::vector<Vec3>& points, const Subdivision& subdivision)
    : dual_mesh_(device, subdivision), refit_(device) {
  for (const Vec3& point : multiply(subdivision.weights, points)) mesh_.points.push_back(point.cast<float>());
  mesh_.normals.assign(mesh_.points.size(), Vec3f::UnitZ());  // the device computes them with every move
  mesh_.triangles = subdivision.triangles;
}

Box SoftVisual::follow(const std::vector<Vec3>& nodes, MeshRange& range, DeviceScene& scene) {
  dual_mesh_.follow(nodes, scene.vertices, range.first_vertex);
  Buffer<TriangleBlock>& blocks = scene.trees.blocks;
  refit_(range, scene.triangles, scene.vertices, blocks, scene.trees.nodes);
  const float cost = refit_.cost(range, scene.trees.nodes);
  if (cost_when_built_ == 0) {
    cost_when_built_ = cost;
  } else if (cost > BAD_COST * cost_when_built_) {
    const bool is_new = rebuild(range, mesh_.triangles, scene.vertices, blocks, scene.trees.nodes);
    cost_when_built_ = is_new ? refit_.cost(range, scene.trees.nodes) : cost;
  }
  Box box;
  for (const Vec3& node : nodes) box.add(node.cast<float>());
  return box;
}

}  // namespace pvg
