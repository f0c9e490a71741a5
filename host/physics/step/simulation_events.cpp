// What goes wrong in an attempt at a step: it is named, and the world goes back to where the attempt began.
#include <cmath>
#include <cstdio>

#include "host/physics/step/simulation_impl.hpp"

namespace pvg {
namespace {

// The body that a node is of, and its number in it; -1 for the nodes of a rigid body, which are its frame.
struct NodeOwner {
  std::string body;
  int node = -1;
};

NodeOwner owner_of_node(const System& system, std::size_t world, u32 node) {
  const PhysicalScene& scene = system.scenes[world];
  const auto within = [&](u32 first, std::size_t n) { return node >= first && node < first + n; };
  for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b)
    if (const u32 first = system.soft_first_node[world][b]; within(first, scene.soft_bodies[b].mesh.points.size()))
      return {scene.soft_bodies[b].name, int(node - first)};
  for (std::size_t b = 0; b < scene.cloths.size(); ++b)
    if (const u32 first = system.cloth_first_node[world][b]; within(first, scene.cloths[b].mesh.points.size()))
      return {scene.cloths[b].name, int(node - first)};
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    if (within(system.rigid_first_node[world][b], 4)) return {scene.rigid_bodies[b].name, -1};
  return {};
}

// first tetrahedron whose corners are flat or turned inside out; -1: none.  x: of the body's first node
int find_inverted(const TetMesh& mesh, const double* x) {
  for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
    const std::uint32_t* node = &mesh.elements[e * std::size_t(mesh.nodes_per_element)];
    const auto at = [&](int k) { return Eigen::Map<const Vec3>(x + 3 * node[k]); };
    if (!((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) > 0)) return int(e);
  }
  return -1;
}

const char* name_of(StepEvent::Kind kind) {
  switch (kind) {
    case StepEvent::Kind::not_finite:
      return "a number that is not finite";
    case StepEvent::Kind::inverted_element:
      return "an inverted element";
    case StepEvent::Kind::stalled:
      return "a stalled solve";
    default:
      return "an exhausted line search";
  }
}

}  // namespace

std::string describe(const StepEvent& event, const std::string& scene) {
  char when[96];
  std::snprintf(when, sizeof when, " at %.9g s, in a step of %.3g s: ", event.time, event.length);
  std::string where = event.body.empty() ? "" : " in body " + event.body;
  if (event.element >= 0)
    where += (event.kind == StepEvent::Kind::inverted_element ? ", tetrahedron " : ", node ") +
             std::to_string(event.element);
  return std::string(name_of(event.kind)) + where + " of scene " + scene + when + event.detail;
}

void Simulation::Impl::give_up(StepEvent event) {
  const std::size_t w = event.world;
  event.time = states[w].time;
  event.length = length;
  reports[w].events.push_back(std::move(event));
  is_intact[w] = is_unsettled[w] = is_active[w] = has_read_end = read_end_of_trial = false;
  const std::size_t first = 3 * system.node_ranges[w].begin, n = 3 * system.node_ranges[w].end - first;
  x.node.write(first, start.node.read(first, n));
  dx.write(first, std::vector<double>(n, 0));
  potential.update_sites(x);
}

void Simulation::Impl::give_up(std::size_t world, StepEvent::Kind kind, u32 node, const std::string& detail) {
  const NodeOwner owner = owner_of_node(system, world, node);
  give_up({kind, world, 0, 0, owner.body, owner.node, detail});
}

void Simulation::Impl::give_up_inverted() {
  for (std::size_t w = 0; w < is_intact.size(); ++w)
    for (std::size_t b = 0; is_intact[w] && b < system.scenes[w].soft_bodies.size(); ++b) {
      const SoftBody& body = system.scenes[w].soft_bodies[b];
      const int element = find_inverted(body.mesh, &nodes[3 * system.soft_first_node[w][b]]);
      if (element >= 0)
        give_up({StepEvent::Kind::inverted_element, w, 0, 0, body.name, element, "its volume is not positive"});
    }
}

std::optional<u32> Simulation::Impl::first_not_finite(const std::vector<double>& values, std::size_t world) const {
  for (u32 i = 3 * system.node_ranges[world].begin; i < 3 * system.node_ranges[world].end; ++i)
    if (!std::isfinite(values[i])) return i / 3;
  return std::nullopt;
}

std::optional<u32> Simulation::Impl::first_not_finite(const Buffer<f64>& values, std::size_t world) const {
  return first_not_finite(values.read(), world);
}

u32 Simulation::Impl::fastest_node(std::size_t world) const {
  const u32 first = system.node_ranges[world].begin, end = system.node_ranges[world].end;
  const std::vector<double> numbers = dx.read(3 * first, 3 * (end - first));
  u32 fastest = first;
  double largest_move = -1;
  for (u32 node = first; node < end; ++node)
    if (const double move = Eigen::Map<const Vec3>(&numbers[3 * (node - first)]).norm(); move > largest_move) {
      largest_move = move;
      fastest = node;
    }
  return fastest;
}

}  // namespace pvg
