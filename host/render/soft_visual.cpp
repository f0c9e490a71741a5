#include "host/render/soft_visual.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <numeric>

#include "host/base/error.hpp"
#include "host/geometry/tet_embedding.hpp"

namespace pvg {
namespace {

// edges sharper than this stay sharp when the surface is subdivided: a finger's ribs keep their shape [rad]
constexpr double CREASE_ANGLE = 0.7;
// a tree that costs so much more than when it was built is built anew
constexpr float BAD_COST = 1.4f;
constexpr int MAX_LEVELS = 4;  // each level has four times the triangles
// no point of an embedded mesh is further outside its body, in units of the body's size
constexpr double FARTHEST = 0.1;
// a cloth's texture repeats so often along x and y of its own frame, as woven or printed on the flat cloth [m]
constexpr float CLOTH_TILE = 0.05f;

CarriedMesh subdivided(const std::string& body, const std::vector<Vec3>& points, const std::vector<Triangle>& surface,
                       const Visual& visual) {
  if (visual.subdivision_levels < 0 || visual.subdivision_levels > MAX_LEVELS)
    throw UsageError("visual " + visual.name + ": subdivision_levels is " + std::to_string(visual.subdivision_levels) +
                     "; 0 to " + std::to_string(MAX_LEVELS));
  if (surface.empty()) throw UsageError("visual " + visual.name + ": soft body " + body + " has no surface");
  Subdivision fine =
      subdivide_loop(points.size(), surface, visual.subdivision_levels, sharp_edges(points, surface, CREASE_ANGLE));
  CarriedMesh mesh{std::move(fine.weights), {}, {}};
  for (const Vec3& point : multiply(mesh.weights, points)) mesh.rest.points.push_back(point.cast<float>());
  mesh.rest.normals.assign(mesh.rest.points.size(), Vec3f::UnitZ());  // computed with every move
  mesh.rest.triangles = std::move(fine.triangles);
  mesh.normal_from.resize(mesh.rest.points.size());
  std::iota(mesh.normal_from.begin(), mesh.normal_from.end(), 0u);
  return mesh;
}

// Vertices at one place with one normal are one, but for their texture coordinates.
std::vector<std::uint32_t> first_of_equals(const VisualMesh& mesh) {
  std::map<std::array<float, 6>, std::uint32_t> known;
  std::vector<std::uint32_t> first;
  for (std::uint32_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3f &p = mesh.points[i], n = mesh.normals.empty() ? Vec3f::Zero() : mesh.normals[i];
    first.push_back(known.insert({{p.x(), p.y(), p.z(), n.x(), n.y(), n.z()}, i}).first->second);
  }
  return first;
}

std::string millimetres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", 1e3 * length);
  return text;
}

CarriedMesh embedded(const SoftBody& body, const VisualMesh& fine, const Visual& visual) {
  std::vector<Vec3> points;
  for (const Vec3f& point : fine.points) {
    if (!point.allFinite()) throw UsageError("visual " + visual.name + ": a point of its mesh is not finite");
    points.push_back(point.cast<double>());
  }
  Embedding embedding = embed_points(body.mesh, points);
  const Eigen::AlignedBox3d box = [&] {
    Eigen::AlignedBox3d all;
    for (const Vec3& point : body.mesh.points) all.extend(point);
    return all;
  }();
  const double allowed = FARTHEST * box.diagonal().norm();
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!(embedding.distance[i] <= allowed))
      throw UsageError("visual " + visual.name + ": vertex " + std::to_string(i) + " of its mesh is " +
                       millimetres(embedding.distance[i]) + " outside of soft body " + body.name + ", at most " +
                       millimetres(allowed) + " are carried along; make the mesh fit the body in its own frame");
  return {std::move(embedding.weights), fine, first_of_equals(fine)};
}

}  // namespace

CarriedMesh carried_mesh(const Scene& scene, const Visual& visual) {
  if (visual.cloth >= 0) {
    const Cloth& cloth = scene.cloths[std::size_t(visual.cloth)];
    if (visual.mesh >= 0)
      throw UsageError("visual " + visual.name + ": a cloth is shown by its own surface; leave its mesh out");
    CarriedMesh mesh = subdivided(cloth.name, cloth.mesh.points, cloth.mesh.triangles, visual);
    for (const Vec3f& point : mesh.rest.points) mesh.rest.uvs.push_back(point.head<2>() / CLOTH_TILE);
    return mesh;
  }
  const SoftBody& body = scene.soft_bodies[std::size_t(visual.soft)];
  if (visual.mesh >= 0) return embedded(body, scene.visual_meshes[std::size_t(visual.mesh)], visual);
  return subdivided(body.name, body.mesh.points, body.mesh.surface, visual);
}

std::vector<Vec3f> moved_normals(const CarriedMesh& mesh, const std::vector<Vec3f>& points) {
  std::vector<Vec3f> sums(points.size(), Vec3f::Zero());
  for (const Triangle& t : mesh.rest.triangles) {
    const Vec3f n = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    for (const std::uint32_t corner : t) sums[mesh.normal_from[corner]] += n;
  }
  std::vector<Vec3f> normals;
  // a vertex of no triangle has none; any will do
  for (const std::uint32_t first : mesh.normal_from)
    normals.push_back(sums[first].norm() > 0 ? Vec3f(sums[first].normalized()) : Vec3f::UnitZ());
  return normals;
}

SoftVisual::SoftVisual(Device& device, CarriedMesh mesh)
    : mesh_(std::move(mesh.rest)),
      dual_mesh_(device, mesh.weights, mesh_.triangles, mesh.normal_from),
      refit_(device) {}

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
  return root_box(range, scene.trees.nodes);
}

}  // namespace pvg
