// Orders of elimination that keep a Cholesky factor sparse. None is best for all: bodies with holes and branches want
// minimum degree, solid bars a sweep (2700 nodes, 3 x 9 x 100: 24 % less work; fin-ray ladders: ten times more),
// compact solids dissection (12,167 nodes, a cube: half the work of minimum degree).
#pragma once
#include <span>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "shared/types.h"

namespace pvg {

// Neighbours of each node, both ways, without itself.
struct NodeGraph {
  std::vector<u32> first;      // [n_nodes + 1]
  std::vector<u32> neighbour;  // [2 n_edges]
  u32 n_nodes() const { return u32(first.size() - 1); }
};

enum class NodeOrder { minimum_degree, two_ended_sweep, nested_dissection };

// All return the node at each position in the order.
// Approximate minimum degree (Amestoy, Davis, Duff 1996), Eigen's.
std::vector<u32> minimum_degree_order(const NodeGraph& graph);
// From both ends of each connected part towards its middle, in the order of a breadth-first search (Cuthill, McKee
// 1969): a narrow band, in two halves that do not depend on each other.
std::vector<u32> two_ended_sweep(const NodeGraph& graph);
// Halves the nodes again and again by planes across an axis, each time where the fewest nodes lie at the cut; these
// come last (George 1973). position: [n_nodes, m]
std::vector<u32> nested_dissection(const NodeGraph& graph, std::span<const Vec3> position);

}  // namespace pvg
