// The multilevel additive Schwarz preconditioner on the device: made from the assembled matrix and the contacts' blocks
// (kernels/solve/multilevel_schwarz.cl has the formula, schwarz_hierarchy.hpp the levels).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/block_matrix.hpp"
#include "host/physics/linear/schwarz_hierarchy.hpp"
#include "host/physics/linear/world_reduce.hpp"

namespace pvg {

class MultilevelSchwarz {
 public:
  // matrix: whose pattern the levels follow; it must outlive this. sites: those of the terms.
  MultilevelSchwarz(Device& device, const BlockMatrix& matrix, std::span<const Site> sites, const SchwarzNodes& nodes,
                    u32 width, std::size_t most_levels);

  // Sums and inverts the clusters' matrices at the present blocks. contacts: at most two terms of four sites.
  void start_factorize(std::span<const Term* const> contacts);
  // A node of the first cluster whose matrix is not positive definite, or nothing; after the device was waited for.
  std::optional<u32> failed() const;
  std::optional<u32> factorize(std::span<const Term* const> contacts);  // both
  // preconditioned = M^-1 residual, zero on fixed nodes [n_nodes x 3]; and chunks.partial(): their product over each
  // chunk of at most 64 nodes. exact: of which the first level's inverses are added in double precision, or nothing.
  void apply(const Buffer<f64>& residual, Buffer<f64>& preconditioned, const MultilevelSchwarz* exact,
             WorldChunks& chunks);

  std::size_t n_clusters() const { return levels_.empty() ? 0 : levels_.front().n_clusters; }  // of the first level
  std::size_t n_bytes() const { return sizeof(float) * inverse_.size(); }                      // of the inverses

 private:
  struct Level {
    Level(Device& device, const SchwarzLevel& level, const std::vector<u32>& row, const std::vector<u32>& column);
    u32 n_clusters, first_cluster = 0;  // the first one's number through all levels
    // blocks of this level's matrix, of the coarser levels in coarse_blocks_ from first_block on
    u32 first_block = 0;
    Buffer<u32> row, column;
    // the next level's blocks: which of this level's they are made of
    Buffer<u32> pair_first, pair_source;
    u32 n_pairs = 0;
    Buffer<f64> weights;
    std::vector<u32> site_slot;  // of each site its first slot
  };
  // blocks within clusters, and where they go
  struct Places {
    std::vector<u32> source, row, column;
  };
  void find_coarse_blocks(Level& level, const SchwarzLevel& shape, std::vector<u32>& row, std::vector<u32>& column);
  void add_places(const Level& level, const std::vector<u32>& row, const std::vector<u32>& column,
                  Places& places) const;
  void find_functions(const SchwarzHierarchy& hierarchy);
  void find_site_slots(std::span<const Site> sites, const SchwarzHierarchy& hierarchy);
  void list_contacts(std::span<const Term* const> contacts);
  void add_contacts(std::span<const Term* const> contacts);
  u32 position(const Level& level, u32 slot) const;  // where its numbers begin in a vector of all clusters

  const BlockMatrix& matrix_;
  u32 width_ = 1, stride_ = 4, n_coarser_ = 0;
  std::vector<u32> node_of_cluster_;  // [n_clusters of the first level] one of its nodes
  Program program_;
  Kernel coarsen_, place_, add_contacts_, invert_, restrict_, solve_, prolong_;
  Buffer<u32> node_of_slot_, slot_of_node_, failed_;
  mutable std::vector<u32> has_failed_;  // [n_clusters of all levels] as read
  std::vector<Level> levels_;
  Buffer<f64> coarse_blocks_;
  Buffer<u32> within_source_, within_row_, within_column_;  // Places
  Buffer<f64> matrices_;                                    // of all clusters
  Buffer<float> inverse_, z_;
  // as in the kernels: functions of all coarser levels on the first, and what adds to them
  Buffer<float> functions_;
  Buffer<f64> parts_;
  Buffer<u32> coarser_, level_, member_first_, member_;
  // contacts
  std::vector<std::vector<u32>> listed_sites_;  // of each term, which the following was made of
  u32 n_sites_ = 0, n_part_pairs_ = 0;
  Buffer<f64> site_weights_;
  Buffer<u32> part_pair_row_, part_pair_column_, part_first_, long_pairs_, part_source_, part_row_, part_column_;
};

}  // namespace pvg
