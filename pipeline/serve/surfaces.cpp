#include "pipeline/serve/surfaces.hpp"

#include <algorithm>

#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/tet_mesh.hpp"

namespace pvg {

Surfaces::Surfaces(const PhysicalScene& scene) {
  for (const RigidBody& body : scene.rigid_bodies) {
    add(body.name, body.collision.triangles, body.collision.points.size());
    bodies_.back().rest = body.collision.points;
    bodies_.back().is_rigid = true;
    bodies_.back().goes_its_way = body.is_fixed || body.is_prescribed;
  }
  for (const SoftBody& body : scene.soft_bodies) add(body.name, body.mesh.surface, body.mesh.points.size());
  for (const Cloth& cloth : scene.cloths) add(cloth.name, cloth.mesh.triangles, cloth.mesh.points.size());
  const auto leave_out = [&](int a, int b) { noncolliding_.insert(std::minmax(std::size_t(a), std::size_t(b))); };
  for (const Joint& joint : scene.joints) leave_out(joint.parent, joint.child);
  for (const auto& [a, b] : scene.noncolliding_rigid_bodies) leave_out(a, b);
}

void Surfaces::add(const std::string& name, const std::vector<Triangle>& triangles, std::size_t n_points) {
  std::set<Edge> edges;  // open surfaces have edges that stand in one triangle alone
  const auto first = std::uint32_t(n_points_);
  for (const Triangle& corners : triangles) {
    const Triangle t = {first + corners[0], first + corners[1], first + corners[2]};
    triangles_.push_back(t);
    for (std::size_t k = 0; k < 3; ++k) edges.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  }
  edges_.insert(edges_.end(), edges.begin(), edges.end());
  triangle_body_.resize(triangles_.size(), bodies_.size());
  edge_body_.resize(edges_.size(), bodies_.size());
  bodies_.push_back({name, {}, false, false});
  n_points_ += n_points;
}

std::string Surfaces::meeting(const WorldState& state) const {
  std::vector<Vec3> points;
  points.reserve(n_points_);
  for (std::size_t i = 0; i < state.rigid.size(); ++i)
    for (const Vec3& rest : bodies_[i].rest)
      points.push_back(state.rigid[i].leftCols<3>() * rest + state.rigid[i].col(3));
  for (const std::vector<std::vector<Vec3>>* bodies : {&state.soft, &state.cloth})
    for (const std::vector<Vec3>& body : *bodies) points.insert(points.end(), body.begin(), body.end());
  const auto may_overlap = [&](std::uint32_t edge, std::uint32_t triangle) {
    const std::size_t a = edge_body_[edge], b = triangle_body_[triangle];
    if (a == b) return bodies_[a].is_rigid;
    return (bodies_[a].goes_its_way && bodies_[b].goes_its_way) || noncolliding_.contains(std::minmax(a, b));
  };
  const auto found = find_intersection(points, edges_, triangles_, may_overlap);
  return found ? bodies_[edge_body_[found->edge]].name + " and " + bodies_[triangle_body_[found->triangle]].name : "";
}

}  // namespace pvg
