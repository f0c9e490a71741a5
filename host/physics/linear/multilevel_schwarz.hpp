// The multilevel additive Schwarz preconditioner on the device: made from the assembled matrix and the contacts' blocks
// (kernels/solve/multilevel_schwarz.cl has the formula, schwarz_hierarchy.hpp the levels).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/block_matrix.hpp"
#include "host/physics/linear/schwarz_hierarchy.hpp"

namespace pvg {

class MultilevelSchwarz {
 public:
  // matrix: whose pattern the levels follow; it must outlive this. sites: those of the terms.
  MultilevelSchwarz(Device& device, const BlockMatrix& matrix, std::span<const Site> sites, const SchwarzNodes& nodes,
                    u32 width, std::size_t most_levels);

  // Sums and inverts the clusters' matrices at the present blocks. contacts: terms of four sites.
  void start_factorize(std::span<const Term* const> contacts);
  // A node of the first cluster whose matrix is not positive definite, or nothing; after the device was waited for.
  std::optional<u32> failed() const;
  std::optional<u32> factorize(std::span<const Term* const> contacts);  // both
  // preconditioned = M^-1 residual;  [n_nodes x 3], zero on fixed nodes
  void apply(const Buffer<f64>& residual, Buffer<f64>& preconditioned);

  // preconditioned += B^-1 residual of the first level, in double precision
  void add_exactly(const Buffer<f64>& residual, Buffer<f64>& preconditioned);

  std::size_t n_levels() const { return levels_.size(); }
  std::size_t n_clusters() const;  // of the first level
  std::size_t n_bytes() const;     // of the inverses

 private:
  struct Level {
    Level(Device& device, const SchwarzLevel& level, u32 stride, const std::vector<u32>& row,
          const std::vector<u32>& column);
    u32 width, stride, n_clusters;
    // blocks of this level's matrix: none of its own on the first level, whose blocks are those of the given matrix
    Buffer<u32> row, column, within;
    Buffer<f64> blocks;
    // the next level's blocks: which of this level's they are made of
    Buffer<u32> pair_first, pair_source;
    u32 n_pairs = 0;
    Buffer<u32> parent;
    Buffer<f64> weights, matrices;
    Buffer<float> inverse, restricted, z;
    u32 first_cluster = 0;  // in the list of failures
    // contacts: of each site its first slot and the weights of the functions from there on
    std::vector<u32> site_slot;
    std::vector<std::array<double, 4>> site_weight;
    Buffer<f64> site_weights;
    Buffer<u32> part_pair_row, part_pair_column, part_first, part_source, part_row, part_column;
  };
  void find_coarse_blocks(Level& level, const SchwarzLevel& shape, std::vector<u32>& row, std::vector<u32>& column);
  void find_site_slots(std::span<const Site> sites, const SchwarzHierarchy& hierarchy);
  void add_contacts(Level& level, const Term& contacts);

  const BlockMatrix& matrix_;
  std::vector<u32> node_of_cluster_;  // [n_clusters of the first level] one of its nodes
  Program program_;
  Kernel coarsen_, place_, add_contacts_, invert_, gather_, restrict_, solve_, scatter_, add_exactly_;
  Buffer<u32> node_of_slot_, slot_of_node_, failed_;
  mutable std::vector<u32> has_failed_;  // [n_clusters of all levels] as read
  std::vector<Level> levels_;
};

}  // namespace pvg
