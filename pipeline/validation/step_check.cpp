#include "pipeline/validation/step_check.hpp"

#include <cmath>

namespace pvg {
namespace {

// All nodes of the world, in the order of System [n_nodes x 3, m]
std::vector<Vec3> nodes_of(const WorldState& state) {
  std::vector<Vec3> nodes;
  for (const auto& points : state.soft) nodes.insert(nodes.end(), points.begin(), points.end());
  for (const auto& points : state.cloth) nodes.insert(nodes.end(), points.begin(), points.end());
  for (const AffineMap& map : state.rigid)
    for (const int column : {3, 0, 1, 2}) nodes.push_back(map.col(column));
  return nodes;
}

std::vector<Vec3> sites_of(const System& system, const std::vector<Vec3>& nodes) {
  std::vector<Vec3> sites;
  for (const Site& site : system.sites) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 4; ++k)
      if (site.weight[k] != 0) sum += site.weight[k] * nodes[site.node[k]];
    sites.push_back(sum);
  }
  return sites;
}

// Jacobian of a 10-node element at barycentric coordinates l: positive where it is upright
double jacobian(const std::array<Vec3, 10>& x, const std::array<double, 4>& l) {
  constexpr int EDGES[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  std::array<Vec3, 4> slope;  // dx / dl_k
  for (int k = 0; k < 4; ++k) slope[k] = (4 * l[k] - 1) * x[k];
  for (int e = 0; e < 6; ++e) {
    slope[EDGES[e][0]] += 4 * l[EDGES[e][1]] * x[4 + e];
    slope[EDGES[e][1]] += 4 * l[EDGES[e][0]] * x[4 + e];
  }
  return (slope[1] - slope[0]).cross(slope[2] - slope[0]).dot(slope[3] - slope[0]);
}

}  // namespace

bool is_upright(const TetMesh& mesh, std::size_t element, const std::vector<Vec3>& x) {
  const std::uint32_t* n = &mesh.elements[element * mesh.nodes_per_element];
  if (!((x[n[1]] - x[n[0]]).cross(x[n[2]] - x[n[0]]).dot(x[n[3]] - x[n[0]]) > 0)) return false;
  if (mesh.nodes_per_element != 10) return true;
  std::array<Vec3, 10> nodes;
  for (int k = 0; k < 10; ++k) nodes[k] = x[n[k]];
  const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
  for (int q = 0; q < 4; ++q) {
    std::array<double, 4> l = {far, far, far, far};
    l[q] = near;
    if (!(jacobian(nodes, l) > 0)) return false;
  }
  return true;
}

StepCheck::StepCheck(const PhysicalScene& scene) : system_(make_system(std::vector<PhysicalScene>{scene})) {
  const CollisionMesh& mesh = system_.collision;
  const BodyPairTable table = make_body_pair_table(mesh);
  std::vector<bool> has_surface(mesh.bodies.size(), false);
  for (const CollisionTriangle& triangle : mesh.triangles) has_surface[triangle.body] = true;
  for (u32 a = 0; a < mesh.bodies.size(); ++a)
    for (u32 b = 0; b <= a; ++b) can_touch_ |= has_surface[a] && has_surface[b] && table(mesh, a, b) >= 0;
}

void StepCheck::look(const WorldState& state, const StepReport& report, StepCounts& counts) const {
  const PhysicalScene& scene = system_.scenes[0];
  const auto blame = [&](const std::string& what) {
    if (counts.first_fault.empty()) counts.first_fault = what + " at " + std::to_string(state.time) + " s";
  };
  ++counts.steps;
  counts.has_contact |= can_touch_;
  counts.has_solids |= !scene.soft_bodies.empty();
  if (!(report.residual <= scene.solver.velocity_tolerance)) {
    ++counts.unconverged;
    blame("not converged");
  }
  for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b) {
    const TetMesh& mesh = scene.soft_bodies[b].mesh;
    for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
      if (is_upright(mesh, e, state.soft[b])) continue;
      ++counts.inverted;
      blame("tetrahedron " + std::to_string(e) + " of " + scene.soft_bodies[b].name + " inverted");
    }
  }
  if (!can_touch_) return;
  const auto found = find_surface_intersection(system_.collision, sites_of(system_, nodes_of(state)));
  if (!found) return;
  ++counts.intersecting;
  blame(body_name(scene, found->first_body) + " and " + body_name(scene, found->second_body) + " intersect");
}

}  // namespace pvg
