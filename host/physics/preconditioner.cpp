#include "host/physics/preconditioner.hpp"

#include <algorithm>

namespace pvg {
namespace {

constexpr u32 CLUSTER_WIDTH = 32;  // nodes of a cluster
constexpr std::size_t MOST_LEVELS = 12;

using Kind = SolverSettings::Preconditioner;

// Groups of the nodes of rigid bodies alone, and the world of each; those without such nodes are gone.
struct RigidGroups {
  std::vector<u32> node_group, world;
};

RigidGroups rigid_groups(const System& system) {
  RigidGroups groups{std::vector<u32>(system.n_nodes(), NO_GROUP), {}};
  std::vector<u32> renumbered(system.group_world.size(), NO_GROUP);
  for (const std::vector<u32>& frames : system.rigid_first_node)
    for (const u32 frame : frames) {
      const u32 group = system.node_group[frame];
      if (group == NO_GROUP) continue;
      if (renumbered[group] == NO_GROUP) {
        renumbered[group] = u32(groups.world.size());
        groups.world.push_back(system.group_world[group]);
      }
      std::fill_n(&groups.node_group[frame], 4, renumbered[group]);
    }
  return groups;
}

std::vector<u32> first_frame_nodes(const System& system) {
  std::vector<u32> first;
  for (const std::vector<u32>& frames : system.rigid_first_node)
    first.insert(first.end(), frames.begin(), frames.end());
  return first;
}

}  // namespace

Preconditioner::Preconditioner(Device& device, const System& system, const BlockMatrix& matrix) : matrix_(matrix) {
  const Kind kind = system.scenes[0].solver.preconditioner;
  if (kind == Kind::factor) {
    groups_ = std::make_unique<GroupPreconditioner>(matrix.pattern(), system.sites, system.x, system.node_group,
                                                    system.group_world, system.contact_couplings);
    return;
  }
  const RigidGroups rigid = rigid_groups(system);
  if (!rigid.world.empty())
    groups_ = std::make_unique<GroupPreconditioner>(matrix.pattern(), system.sites, system.x, rigid.node_group,
                                                    rigid.world, system.contact_couplings);
  const std::vector<u32> frames = first_frame_nodes(system);
  const bool has_levels = kind == Kind::schwarz;
  schwarz_ = std::make_unique<MultilevelSchwarz>(
      device, matrix, system.sites, SchwarzNodes{system.x, system.node_world, system.node_is_fixed, frames},
      has_levels ? CLUSTER_WIDTH : 1, has_levels ? MOST_LEVELS : 1);
}

std::optional<u32> Preconditioner::factorize(std::span<const Term* const> contacts,
                                             std::span<const char> world_is_active) {
  if (schwarz_)
    if (const auto node = schwarz_->factorize(contacts)) return node;
  return groups_ ? groups_->factorize(matrix_, contacts, world_is_active) : std::nullopt;
}

void Preconditioner::apply(const Buffer<f64>& residual, Buffer<f64>& preconditioned) {
  if (schwarz_) schwarz_->apply(residual, preconditioned);
  if (!groups_) return;
  const std::vector<double> r = residual.read();
  std::vector<double> z(r.size());
  groups_->apply(r, z);
  if (schwarz_) {
    const std::vector<double> of_schwarz = preconditioned.read();
    std::transform(z.begin(), z.end(), of_schwarz.begin(), z.begin(), std::plus<>());
  }
  preconditioned.write(z);
}

std::size_t Preconditioner::n_bytes() const {
  return (groups_ ? sizeof(double) * groups_->n_numbers() : 0) + (schwarz_ ? schwarz_->n_bytes() : 0);
}

void Preconditioner::couple(std::span<const NodePair> pairs) {
  if (takes_contacts()) groups_->couple(pairs);
}

}  // namespace pvg
