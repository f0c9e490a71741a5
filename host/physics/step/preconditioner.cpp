#include "host/physics/step/preconditioner.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>

namespace pvg {
namespace {

constexpr u32 CLUSTER_WIDTH = 32;  // nodes of a cluster
constexpr std::size_t MOST_LEVELS = 12;
// Operations of a factor up to which it is the faster one on two cores: on a compact solid the turn is between 3,000
// nodes (1e9, 0.8 times the time of Schwarz) and 12,000 (2.3e10, 1.7 times); docs/measured/2026-11-22_bench_solver.md.
constexpr double LARGEST_FACTOR = 5e9;

using Kind = SolverSettings::Preconditioner;

// Which nodes have a factor, and the world of each factor. Groups without any such node are gone.
struct FactorGroups {
  std::vector<u32> node_group, world;
};

// All nodes of groups that are exact, the rigid bodies' of the others.
FactorGroups factor_groups(const System& system, const std::vector<char>& is_exact) {
  std::vector<char> is_rigid(system.n_nodes(), false);
  for (const std::vector<u32>& frames : system.rigid_first_node)
    for (const u32 frame : frames) std::fill_n(&is_rigid[frame], 4, true);
  FactorGroups groups{std::vector<u32>(system.n_nodes(), NO_GROUP), {}};
  std::vector<u32> renumbered(system.group_world.size(), NO_GROUP);
  for (std::size_t node = 0; node < system.n_nodes(); ++node) {
    const u32 group = system.node_group[node];
    if (group == NO_GROUP || !(is_exact[group] || is_rigid[node])) continue;
    if (renumbered[group] == NO_GROUP) {
      renumbered[group] = u32(groups.world.size());
      groups.world.push_back(system.group_world[group]);
    }
    groups.node_group[node] = renumbered[group];
  }
  return groups;
}

std::vector<u32> first_frame_nodes(const System& system) {
  std::vector<u32> first;
  for (const std::vector<u32>& frames : system.rigid_first_node)
    first.insert(first.end(), frames.begin(), frames.end());
  return first;
}

bool holds_frames_only(const FactorGroups& groups, std::span<const u32> first_frame_node) {
  std::size_t n = 0;
  for (const u32 node : first_frame_node) n += groups.node_group[node] == NO_GROUP ? 0 : 4;
  return n == groups.node_group.size() -
                  std::size_t(std::count(groups.node_group.begin(), groups.node_group.end(), NO_GROUP));
}

// nodes of it
u32 largest_group(const FactorGroups& groups) {
  std::vector<u32> n(groups.world.size() + 1, 0);
  for (const u32 group : groups.node_group)
    if (group != NO_GROUP) ++n[group];
  return *std::max_element(n.begin(), n.end());
}

// Which device factors: that of the simulation, or none, then the host does. On the host's own processor the host's
// factor is the faster one (docs/measured/2026-11-25_counts.md); from any other device the matrix would travel for it.
// PVG_FACTOR=host or device takes the other, for tests and measurements.
Device* factoring_device(Device& device) {
  const char* wanted = std::getenv("PVG_FACTOR");
  if (wanted && std::string(wanted) != "host" && std::string(wanted) != "device")
    throw UsageError("PVG_FACTOR is " + std::string(wanted) + "; it must be host or device, or not be set");
  const bool is_wanted = wanted ? std::string(wanted) == "device" : !device.info().runs_host_functions;
  return is_wanted ? &device : nullptr;
}

// Threads of the host that factor: a CPU may be one compute unit of the machine's.
std::size_t host_threads(const DeviceInfo& device) {
  const std::size_t all = std::max(1u, std::thread::hardware_concurrency());
  return device.runs_host_functions ? std::min<std::size_t>(all, device.compute_units) : all;
}

}  // namespace

Preconditioner::Preconditioner(Device& device, const System& system, const BlockMatrix& matrix)
    : matrix_(matrix), factor_group_(system.node_group), factors_on_device_(factoring_device(device) != nullptr) {
  const Kind kind = system.scenes[0].solver.preconditioner;
  std::vector<char> is_exact(system.group_world.size(), kind == Kind::automatic || kind == Kind::factor);
  if (kind == Kind::automatic || kind == Kind::factor)
    groups_ = std::make_unique<GroupPreconditioner>(matrix.pattern(), system.sites, system.x, system.node_group,
                                                    system.group_world, system.contact_couplings,
                                                    factoring_device(device), host_threads(device.info()));
  if (kind == Kind::automatic)
    for (std::size_t group = 0; group < is_exact.size(); ++group)
      is_exact[group] = groups_->cost(u32(group)) <= LARGEST_FACTOR;
  if (std::all_of(is_exact.begin(), is_exact.end(), [](char exact) { return exact; })) return;

  const FactorGroups kept = factor_groups(system, is_exact);
  factor_group_ = kept.node_group;
  takes_contacts_ = std::any_of(is_exact.begin(), is_exact.end(), [](char exact) { return exact; });
  groups_.reset();
  const std::vector<u32> frames = first_frame_nodes(system);
  if (holds_frames_only(kept, frames) && largest_group(kept) <= CLUSTER_WIDTH) {
    takes_contacts_ = false;
    std::vector<u32> has_no_frame(system.n_nodes());
    for (std::size_t node = 0; node < has_no_frame.size(); ++node)
      has_no_frame[node] = kept.node_group[node] == NO_GROUP;
    frames_ = std::make_unique<MultilevelSchwarz>(device, matrix, system.sites,
                                                  SchwarzNodes{system.x, system.node_world, has_no_frame, frames},
                                                  std::max(8u, largest_group(kept)), 1);
  } else if (!kept.world.empty())
    groups_ = std::make_unique<GroupPreconditioner>(matrix.pattern(), system.sites, system.x, kept.node_group,
                                                    kept.world, system.contact_couplings, factoring_device(device),
                                                    host_threads(device.info()));
  std::vector<u32> is_left_out(system.n_nodes());
  for (std::size_t node = 0; node < is_left_out.size(); ++node)
    is_left_out[node] = system.node_group[node] == NO_GROUP || is_exact[system.node_group[node]];
  const bool has_levels = kind != Kind::block_jacobi;
  schwarz_ = std::make_unique<MultilevelSchwarz>(device, matrix, system.sites,
                                                 SchwarzNodes{system.x, system.node_world, is_left_out, frames},
                                                 has_levels ? CLUSTER_WIDTH : 1, has_levels ? MOST_LEVELS : 1);
}

void Preconditioner::start_factorize(const ContactElements& contacts, std::span<const char> world_is_active,
                                     const Buffer<f64>* gradient, std::span<const char> world_keeps) {
  if (schwarz_) schwarz_->start_factorize(contacts.terms);
  if (frames_) frames_->start_factorize(contacts.terms);
  if (groups_) groups_->start_factorize(matrix_.blocks(), contacts, world_is_active, gradient, world_keeps);
}

std::optional<u32> Preconditioner::failed() const {
  for (const MultilevelSchwarz* part : {schwarz_.get(), frames_.get()})
    if (part)
      if (const auto node = part->failed()) return node;
  return groups_ ? groups_->failed() : std::nullopt;
}

bool Preconditioner::apply(const Buffer<f64>& residual, Buffer<f64>& preconditioned, WorldChunks& chunks) {
  if (schwarz_) schwarz_->apply(residual, preconditioned, frames_.get(), chunks);
  if (groups_) groups_->start_apply(residual, schwarz_ != nullptr, preconditioned);
  return !groups_;
}

std::size_t Preconditioner::n_bytes() const {
  return (groups_ ? groups_->n_bytes() : 0) + (schwarz_ ? schwarz_->n_bytes() : 0);
}

void Preconditioner::couple(std::span<const NodePair> pairs) {
  if (!takes_contacts()) return;
  std::vector<NodePair> held;
  for (const NodePair& pair : pairs)
    if (factor_group_[pair[0]] != NO_GROUP && factor_group_[pair[1]] != NO_GROUP) held.push_back(pair);
  groups_->couple(held);
}

}  // namespace pvg
