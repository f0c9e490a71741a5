// What approximates the inverse of the Hessian for conjugate gradients, as `solver: preconditioner` says:
//   factor        one exact sparse factor per group of connected bodies (group_preconditioner.hpp)
//   schwarz       multilevel additive Schwarz on the device (multilevel_schwarz.hpp)
//   block_jacobi  the inverse of each node's own 3 x 3 block, on the device
//   automatic     factor, but schwarz for groups whose factor takes too many operations
// The host factors where the device is its own processor, elsewhere the device does (device_factor.hpp): else the
// matrix would travel, 7 MB an iteration of Newton's for a gripper. With schwarz and block_jacobi the rigid bodies of a
// group have exact inverses besides: the sum acts. Up to 8 bodies in one group these are on the device, of more they
// are factors.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/physics/energies/system.hpp"
#include "host/physics/linear/group_preconditioner.hpp"
#include "host/physics/linear/multilevel_schwarz.hpp"

namespace pvg {

class Preconditioner {
 public:
  // matrix must outlive this
  Preconditioner(Device& device, const System& system, const BlockMatrix& matrix);

  // Starts to factor, at the matrix's present blocks and those of the contacts, which must not change before the device
  // was waited for.
  // gradient: what the first apply() is to will be -gradient [n_nodes x 3]. world_keeps: [n_worlds] whose factors stay,
  // where keeps_factors(); or empty, then none do
  void start_factorize(const ContactElements& contacts, std::span<const char> world_is_active,
                       const Buffer<f64>* gradient = nullptr, std::span<const char> world_keeps = {});
  // Whether start_factorize() can leave a world's factors as they are, the host's without others, and it is worth it.
  bool keeps_factors(u32 world) const {
    return groups_ && !schwarz_ && !factors_on_device_ && groups_->world_cost(world) >= WORTH_KEEPING;
  }
  // A node of what is not positive definite, or nothing; after the device was waited for.
  std::optional<u32> failed() const;
  // preconditioned = M^-1 residual;  [n_nodes x 3]. Returns whether chunks.partial() is their product over each chunk
  // of at most 64 nodes.
  bool apply(const Buffer<f64>& residual, Buffer<f64>& preconditioned, WorldChunks& chunks);
  // Takes further pairs of nodes into the factors, if these hold soft bodies or cloths.
  void couple(std::span<const NodePair> pairs);
  std::size_t n_bytes() const;                             // of factors and inverses
  bool takes_contacts() const { return takes_contacts_; }  // into its factors, by couple()
  // Whether start_factorize() needs to know on the host which sites contacts have.
  bool reads_contacts() const { return schwarz_ || !factors_on_device_; }

 private:
  // Operations of a world's factors. By judgement: below are rigid bodies and joints, whose matrix costs next to
  // nothing.
  static constexpr double WORTH_KEEPING = 1e6;
  const BlockMatrix& matrix_;
  std::vector<u32> factor_group_;  // of each node; NO_GROUP: in no factor
  bool takes_contacts_ = true, factors_on_device_;
  std::unique_ptr<GroupPreconditioner> groups_;
  std::unique_ptr<MultilevelSchwarz> schwarz_, frames_;  // frames_: exact inverses of rigid bodies
};

}  // namespace pvg
