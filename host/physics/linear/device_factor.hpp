// The factors of all groups as kernels of the device: no number of the matrix comes to the host. The host finds order
// and supernodes once per pattern (elimination_tree.hpp), the device assembles, factors and solves
// (kernels/solve/factor_{blocks,fronts,solve}.cl).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/block_matrix.hpp"
#include "host/physics/linear/contact_elements.hpp"
#include "host/physics/linear/elimination_tree.hpp"
#include "host/physics/linear/factor_schedule.hpp"
#include "host/physics/linear/gather.hpp"
#include "host/physics/linear/term.hpp"
#include "solve/factor_front.h"

namespace pvg {

// One matrix to factor; what it refers to must live during DeviceFactor::set().
struct FactorGroup {
  const EliminationTree* tree;
  const BlockPattern* pattern;  // of the group's own nodes
  std::span<const u32> nodes;   // local to global
  std::span<const u32> source;  // of each block of the pattern in the matrix; NO_BLOCK: contact only
  u32 world;
};

class DeviceFactor {
 public:
  DeviceFactor(Device& device, std::size_t n_nodes);
  // The matrices from now on. Throws a UsageError where the factor has more numbers than the device can count.
  void set(std::span<const FactorGroup> groups);

  // Starts to factor the groups of the active worlds at the present blocks. gradient: the first start_apply() will be
  // to -gradient [n_nodes x 3], half of which is then done in the same launches.
  void start_factorize(const Buffer<f64>& matrix_blocks, const ContactElements& contacts,
                       std::span<const char> world_is_active, const Buffer<f64>* gradient = nullptr);
  // The first group that is not positive definite; after the device was waited for.
  std::optional<u32> failed() const;
  // preconditioned (+)= M^-1 residual;  [n_nodes x 3]; zero in groups that are not active or not positive definite
  void start_apply(const Buffer<f64>& residual, bool adds, Buffer<f64>& preconditioned);

  std::size_t n_numbers() const { return panels_.size() + updates_.size(); }  // on the device
  // The factor of a group as a dense lower triangle, for tests: column-major [3 n_nodes x 3 n_nodes] in the order of
  // elimination
  std::vector<double> dense(u32 group) const;

 private:
  // a FactorSchedule on the device
  struct Tasks {
    Tasks(Device& device, const char* name);
    void set(const FactorSchedule& schedule);
    std::vector<u32> stage_first;
    u32 n_stages = 0;
    Buffer<u32> first, front;
  };
  void lay_out(std::span<const FactorGroup> groups);
  void list_blocks(std::span<const FactorGroup> groups);
  void list_holes(const std::vector<char>& is_placed);  // blocks of the panels that nothing is placed in
  void solve_stage(u32 stage, u32 parts, bool adds, const Buffer<f64>& residual, Buffer<f64>& preconditioned);

  std::size_t n_nodes_;
  Program blocks_program_, fronts_program_, solve_program_;
  Kernel place_blocks_, factor_fronts_, factor_solve_;
  std::vector<FactorFront> host_fronts_;               // of all groups
  std::vector<u32> group_front_;                       // [n_groups + 1] where each group's fronts begin
  std::vector<u32> group_world_, host_nodes_, order_;  // order_: the nodes of all groups, as they are eliminated
  std::vector<u32> written_active_;
  std::vector<u32> host_failed_;  // [n_groups] as read
  bool is_half_solved_ = false;   // forward, for the first residual
  Tasks factoring_, solving_;
  Buffer<FactorFront> fronts_;
  Buffer<u32> children_, places_, front_nodes_, lone_nodes_;
  Buffer<u32> row_, column_, source_, place_, stride_, hole_place_, hole_stride_, block_first_, block_last_,
      node_group_;
  Buffer<u32> group_is_active_, failed_;
  Buffer<f64> panels_, updates_, vectors_;
  // for matrices without contacts
  Buffer<u32> no_indices_;
  Buffer<Site> no_sites_;
  Buffer<f64> no_numbers_;
};

}  // namespace pvg
