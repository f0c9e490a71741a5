// The levels of the multilevel additive Schwarz preconditioner: which nodes form a cluster, and how a cluster moves as
// one on the next coarser level. A cluster's coarse functions are the four 1, x, y, z at rest, made orthonormal over
// it, each times the three directions: an affine body with four "nodes" again, so that every level looks alike.
// Clusters follow connectivity: parts of one that no element connects are apart until each connected body is one
// cluster; only then are bodies of a world taken together.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "host/physics/linear/block_matrix.hpp"

namespace pvg {

constexpr u32 NO_SLOT = ~0u;

// Functions of one level stand in slots: cluster c has those from c x width on, padded where it has fewer.
struct SchwarzLevel {
  u32 width = 0;            // slots per cluster
  std::vector<u32> parent;  // [n_clusters] first of its 4 slots on the next level; NO_SLOT on the last
  std::vector<std::array<double, 4>> weights;  // [n_slots] of the four coarse functions; 0 in unused slots
  std::vector<u32> cluster_world;              // [n_clusters]
  std::size_t n_clusters() const { return parent.size(); }
  std::size_t n_slots() const { return n_clusters() * width; }
};

struct SchwarzHierarchy {
  std::vector<u32> slot_of_node;  // [n_nodes] on the first level; NO_SLOT: fixed or left out
  std::vector<SchwarzLevel> levels;
};

struct SchwarzNodes {
  std::span<const double> position;  // at rest [n_nodes x 3, m]
  std::span<const u32> world;        // [n_nodes]
  std::span<const u32> is_fixed;     // [n_nodes] or left out
  std::span<const u32> first_frame;  // first node p of each (p, a1, a2, a3), ascending: these four are not separated
};

// width: most slots of a cluster, at least 8; or 1, for a single level whose clusters are the nodes.
SchwarzHierarchy make_schwarz_hierarchy(const MatrixPattern& pattern, const SchwarzNodes& nodes, u32 width,
                                        std::size_t most_levels);

}  // namespace pvg
