// What a Cholesky factor of a symmetric matrix of 3 x 3 blocks will look like, from the pattern alone: the order in
// which nodes are eliminated, and supernodes, groups of nodes eliminated together because (nearly) the same rows follow
// them. Liu 1990, "The role of elimination trees in sparse factorization"; Ashcraft, Grimes 1989 on relaxed supernodes.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "host/physics/linear/node_order.hpp"
#include "shared/types.h"

namespace pvg {

// Lower triangle of a symmetric matrix of 3 x 3 blocks: the block rows of each block column, ascending, diagonal first.
struct BlockPattern {
  std::vector<u32> column_first;  // [n_nodes + 1]
  std::vector<u32> row;           // [n_blocks]
  u32 n_nodes() const { return column_first.empty() ? 0 : u32(column_first.size() - 1); }
};

constexpr u32 NO_PARENT = ~0u;

struct Supernode {
  u32 first = 0, n_pivots = 0;  // the nodes it eliminates, positions in the order
  std::vector<u32> rows;        // positions of the nodes it couples to, ascending, all behind its own
  u32 parent = NO_PARENT;       // of the supernode that assembles its update
  std::vector<u32> children;
  double cost = 0;  // of itself, predicted, in floating point operations
};

struct EliminationTree {
  std::vector<u32> order;             // [n_nodes] position to node
  std::vector<u32> position;          // [n_nodes] node to position
  std::vector<Supernode> supernodes;  // children before parents, the subtree of each in one piece before it
  double cost = 0;                    // of all
  NodeOrder kind = NodeOrder::minimum_degree;
};

// With the cheapest of the orders of host/physics/linear/node_order.hpp, or the one that is asked for. position: of
// each node [n_nodes, m], or nothing, then without the order that needs it.
EliminationTree eliminate(const BlockPattern& pattern, std::span<const Vec3> position = {},
                          std::optional<NodeOrder> kind = {});

}  // namespace pvg
