// The preconditioner: one exact sparse factor per group of bodies that joints and stitches hold together (a robot with
// its fingers is one group; the bodies that stand alone are another, if they are few), contact and friction within a
// group's own nodes included. What is left to conjugate gradients is the coupling of groups through contact.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "host/base/workers.hpp"
#include "host/physics/block_cholesky.hpp"
#include "host/physics/block_matrix.hpp"
#include "solve/site.h"

namespace pvg {

constexpr u32 NO_GROUP = ~0u;

// Element blocks of one list of elements, on the host: site ids and the dense row-major blocks.
struct ElementBlocks {
  std::size_t stencil = 0;
  std::span<const u32> sites;      // [n_elements x stencil]
  std::span<const double> blocks;  // [n_elements x (3 stencil)^2, N/m]
};

class GroupPreconditioner {
 public:
  // matrix: pattern of what never changes. node_group: group of each node, NO_GROUP for nodes that never move; coupled:
  // further pairs of nodes of one group that contacts may couple and that the factor then includes.
  GroupPreconditioner(const MatrixPattern& matrix, std::span<const Site> sites, std::span<const u32> node_group,
                      std::size_t n_groups, std::span<const std::array<u32, 2>> coupled = {});

  // Reads the matrix, adds the blocks of the contacts, factors the groups for which group_is_active.
  // Returns the first group that is not positive definite, or n_groups().
  std::size_t factorize(const BlockMatrix& matrix, std::span<const ElementBlocks> contacts,
                        std::span<const char> group_is_active);
  // preconditioned = M^-1 residual;  [n_nodes x 3]; zero on nodes without group and in groups that are not active
  void apply(std::span<const double> residual, std::span<double> preconditioned) const;
  std::size_t n_groups() const { return groups_.size(); }
  const std::vector<u32>& nodes(std::size_t group) const { return groups_[group].nodes; }

 private:
  struct Group {
    std::vector<u32> nodes;      // local to global, ascending
    BlockPattern pattern;        // of local nodes
    std::vector<u32> source;     // [n_blocks] of each block in the matrix; NO_BLOCK: contact only
    std::vector<double> blocks;  // [n_blocks x 9]
    std::unique_ptr<BlockCholesky> factor;
    bool is_active = false;
    mutable std::vector<double> local;  // of apply() [n_nodes x 3]
  };
  template <class Found>
  void for_each_block(std::span<const u32> element_sites, std::size_t stencil, const Found& found) const;
  void find_patterns(const MatrixPattern& matrix, std::span<const std::array<u32, 2>> coupled);
  static u32 find_block(const Group& group, u32 row, u32 column);
  void add_contacts(const ElementBlocks& contacts);
  static void leave_out(Group& group, u32 row, u32 column, const double* from, std::size_t width, double weight);
  template <class Task>
  void for_each_active_group(const Task& task) const;

  std::vector<Site> sites_;
  std::vector<u32> node_group_, node_local_;
  std::vector<Group> groups_;
  std::vector<double> values_;  // of the matrix, read from the device
  std::unique_ptr<Workers> workers_;
};

}  // namespace pvg
