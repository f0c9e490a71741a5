// The preconditioner: one sparse factor per group of bodies that joints and stitches hold together (a robot with
// its fingers is one group; the bodies that stand alone are another, if they are few), contact and friction within a
// group's own nodes included. What is left to conjugate gradients is the coupling of groups, and of distant parts of
// one body, through contact; or that is taken into the factor too, where it is told of the pairs of nodes. The host
// factors large groups in single precision, in double where that loses too much (block_cholesky.hpp); a device in
// double.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/base/workers.hpp"
#include "host/physics/linear/block_cholesky.hpp"
#include "host/physics/linear/block_matrix.hpp"
#include "host/physics/linear/device_factor.hpp"
#include "solve/site.h"

namespace pvg {

constexpr u32 NO_GROUP = ~0u;
using NodePair = std::array<u32, 2>;

class GroupPreconditioner {
 public:
  // matrix: pattern of what never changes, which must outlive this. position: of the nodes at first [n_nodes x 3, m].
  // node_group: group of each node, NO_GROUP for nodes
  // that never move; group_world: of each group; coupled: pairs of nodes that contacts may couple at any time;
  // factors_on: the device whose kernels factor and solve, or nothing, then the host does, on n_threads threads.
  GroupPreconditioner(const MatrixPattern& matrix, std::span<const Site> sites, std::span<const double> position,
                      std::span<const u32> node_group, std::span<const u32> group_world,
                      std::span<const NodePair> coupled = {}, Device* factors_on = nullptr,
                      std::size_t n_threads = std::thread::hardware_concurrency());

  // Takes further pairs of nodes into the factors, until the next call; groups that they join share one factor. Groups
  // that are as they were keep theirs.
  void couple(std::span<const NodePair> pairs);

  // Starts, in the order of the device's queue, what takes the matrix's blocks, adds the present ones of the contacts
  // and factors the groups of the active worlds. contacts must not change before the device is waited for.
  // gradient: what the first start_apply() is to will be -gradient [n_nodes x 3].
  // world_keeps: [n_worlds] whose groups keep the factors that they have, where the host factors; or empty, then none
  // do
  void start_factorize(const Buffer<f64>& blocks, const ContactElements& contacts,
                       std::span<const char> world_is_active, const Buffer<f64>* gradient = nullptr,
                       std::span<const char> world_keeps = {});
  // A node of the first group that is not positive definite, or nothing; after the device was waited for.
  std::optional<u32> failed() const;
  std::optional<u32> factorize(const Buffer<f64>& blocks, const ContactElements& contacts,
                               std::span<const char> world_is_active);  // both
  // preconditioned = M^-1 residual;  [n_nodes x 3]; zero on nodes without group, in groups that are not active and in
  // those that are not positive definite. Where the host factors.
  void apply(std::span<const double> residual, std::span<double> preconditioned) const;
  // The same in the order of the queue; adds: to what is there
  void start_apply(const Buffer<f64>& residual, bool adds, Buffer<f64>& preconditioned) const;
  double cost(u32 group) const { return lone_cost_[group]; }  // of a group's factor without contact, operations
  double world_cost(u32 world) const;                         // of those of a world
  std::size_t n_groups() const { return groups_.size(); }
  std::size_t n_bytes() const;  // of all factors

 private:
  struct Group {
    std::vector<u32> joined;      // groups as they are without contact
    std::vector<NodePair> pairs;  // of nodes that are coupled besides the matrix
    u32 world = 0;
    std::vector<u32> nodes;   // local to global, ascending
    BlockPattern pattern;     // of local nodes
    std::vector<u32> source;  // [n_blocks] of each block in the matrix; NO_BLOCK: contact only
    double cost = 0;          // of its factor, operations
    NodeOrder kind{};
    EliminationTree tree;  // where the device factors
    // where the host does
    std::vector<const double*> block_at;  // [n_blocks] in the matrix; in `blocks` where contacts were added
    std::vector<double> blocks;           // [n_blocks x 9]
    std::unique_ptr<BlockCholesky<float>> single_factor;  // of a large group
    std::unique_ptr<BlockCholesky<double>> factor;        // of any other, and where single precision once lost too much
    bool is_active = false, is_renewed = false, is_factored = false,
         is_single = false;             // is_single: is_factored in single precision
    mutable std::vector<double> local;  // of apply() [n_nodes x 3]
  };
  template <class Found>
  void for_each_block(std::span<const u32> element_sites, std::span<const double> block, const Found& found) const;
  std::vector<std::vector<u32>> join(std::span<const NodePair> pairs) const;
  void find_pattern(Group& group) const;
  std::optional<NodeOrder> order_of(const Group& group) const;
  void give_to_device();
  static u32 find_block(const Group& group, u32 row, u32 column);
  void add_contacts(const Term& contacts, std::span<const double> blocks);
  void take_blocks(std::span<const double> values);
  static bool factor(Group& group, Workers* workers);
  static double* own_block(Group& group, u32 block);
  static void leave_out(Group& group, u32 row, u32 column, const double* from, std::size_t width, double weight);
  template <class Task>
  void for_each_group(bool Group::*is_in, const Task& task) const;

  const MatrixPattern& matrix_;
  std::vector<Site> sites_;
  std::vector<double> position_;
  std::vector<u32> lone_group_, group_world_;         // of each node, without contact; of each of these groups
  std::vector<std::vector<u32>> lone_nodes_;          // of each of these groups
  std::vector<std::optional<NodeOrder>> lone_order_;  // the cheapest for each of these groups, without contact
  std::vector<double> lone_cost_;                     // of its factor then
  std::vector<NodePair> always_coupled_;
  std::vector<u32> node_group_, node_local_;  // as they are joined now
  std::vector<Group> groups_;
  std::unique_ptr<Workers> workers_;
  std::unique_ptr<DeviceFactor> device_factor_;  // instead of the groups' own
};

}  // namespace pvg
