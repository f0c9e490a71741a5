#include "pipeline/episode/disabled_pairs.hpp"

#include <algorithm>

#include "host/physics/energies/system.hpp"

namespace pvg {
namespace {

// Vertex of the body's mesh that a site of its surface is.
int vertex_of(const System& system, int body, u32 site) {
  const PhysicalScene& scene = system.scenes.front();
  const int n_rigid = int(scene.rigid_bodies.size());
  const int n_soft = int(scene.soft_bodies.size());
  if (body >= n_rigid + n_soft)
    return int(site - system.cloth_first_node.front()[std::size_t(body - n_rigid - n_soft)]);
  if (body >= n_rigid) return int(site - system.soft_first_node.front()[std::size_t(body - n_rigid)]);
  // a point of a rigid body has its coordinates as weights of the three axes
  const double* weight = system.sites[site].weight;
  const std::vector<Vec3>& points = scene.rigid_bodies[std::size_t(body)].collision.points;
  const auto found = std::find(points.begin(), points.end(), Vec3(weight[1], weight[2], weight[3]));
  if (found == points.end()) throw std::logic_error("a contact site is no vertex of its body");
  return int(found - points.begin());
}

template <std::size_t n>
std::array<int, 3> vertices_of(const System& system, int body, const u32 (&site)[n]) {
  std::array<int, 3> vertices{-1, -1, -1};
  for (std::size_t i = 0; i < n; ++i) vertices[i] = vertex_of(system, body, site[i]);
  return vertices;
}

}  // namespace

std::vector<DisabledPair> disabled_pairs(const PhysicalScene& scene) {
  const System system = make_system(std::span(&scene, 1));
  const CollisionMesh& mesh = system.collision;
  std::vector<DisabledPair> pairs;
  for (const auto& [p, t] : mesh.disabled_point_triangle) {
    const CollisionPoint& point = mesh.points[p];
    const CollisionTriangle& triangle = mesh.triangles[t];
    const int first = int(point.body), second = int(triangle.body);
    pairs.push_back({ContactForce::Kind::point_triangle,
                     first,
                     second,
                     {vertex_of(system, first, point.site), -1, -1},
                     vertices_of(system, second, triangle.site)});
  }
  for (const auto& [a, b] : mesh.disabled_edge_edge) {
    const int first = int(mesh.edges[a].body), second = int(mesh.edges[b].body);
    pairs.push_back({ContactForce::Kind::edge_edge, first, second, vertices_of(system, first, mesh.edges[a].site),
                     vertices_of(system, second, mesh.edges[b].site)});
  }
  return pairs;
}

}  // namespace pvg
