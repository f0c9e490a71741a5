#include "host/physics/potential.hpp"

#include <algorithm>

namespace pvg {
namespace {

std::vector<WorldRange> ranges(const std::vector<u32>& first) {
  std::vector<WorldRange> ranges;
  for (u32 w = 0; w + 1 < first.size(); ++w) ranges.push_back({w, first[w], first[w + 1]});
  return ranges;
}

}  // namespace

Potential::Potential(Device& device, const System& system)
    : system_(system),
      nodes_program_(device, "solve/nodes.cl"),
      nodes_to_sites_(nodes_program_.kernel("nodes_to_sites")),
      gather_rows_(nodes_program_.kernel("gather_rows")),
      sites_(device, system.sites, "sites"),
      node_is_fixed_(device, system.node_is_fixed, "is_fixed"),
      point_inertia_(device, "point_inertia", 1),
      affine_inertia_(device, "affine_inertia", 4),
      neo_hookean_4_(device, "stable_neo_hookean_4", 4),
      neo_hookean_10_(device, "stable_neo_hookean_10", 10),
      orthogonality_(device, "affine_orthogonality", 3),
      stitch_(device, "stitch_spring", 2),
      revolute_(device, "revolute_drive", 4),
      prismatic_(device, "prismatic_drive", 3),
      revolute_limit_(device, "revolute_limit", 4),
      prismatic_limit_(device, "prismatic_limit", 3),
      membrane_(device, "cloth_membrane", 3),
      bending_(device, "triangle_bending", 6),
      barrier_(device, "barrier", 4),
      friction_(device, "friction", 4),
      constant_{&point_inertia_, &affine_inertia_, &neo_hookean_4_,  &neo_hookean_10_,  &orthogonality_, &stitch_,
                &revolute_,      &prismatic_,      &revolute_limit_, &prismatic_limit_, &membrane_,      &bending_},
      all_(constant_),
      constant_gather_(device, system.sites, system.n_nodes()),
      contact_gather_(device, system.sites, system.n_nodes()),
      rows_(device, 0, "rows"),
      element_energy_(device, 0, "energy"),
      world_energy_(device, system.n_worlds(), "world energy"),
      direction_site_(device, 3 * system.sites.size(), "direction sites"),
      reduce_(device, system.n_worlds()),
      candidate_chunks_(device, system.n_worlds()),
      friction_chunks_(device, system.n_worlds()) {
  all_.push_back(&barrier_);
  all_.push_back(&friction_);
  const auto set = [](Term& term, const auto& rows) { term.set(rows.rows, rows.world_first); };
  set(point_inertia_, system.point_inertia);
  set(affine_inertia_, system.affine_inertia);
  set(neo_hookean_4_, system.stable_neo_hookean_4);
  set(neo_hookean_10_, system.stable_neo_hookean_10);
  set(orthogonality_, system.affine_orthogonality);
  set(stitch_, system.stitch_spring);
  set(revolute_, system.revolute_drive);
  set(prismatic_, system.prismatic_drive);
  set(revolute_limit_, system.revolute_limit);
  set(prismatic_limit_, system.prismatic_limit);
  set(membrane_, system.cloth_membrane);
  set(bending_, system.triangle_bending);

  std::vector<RowBlock> blocks;
  std::size_t most_elements = 0;
  for (Term* term : constant_) {
    term->first_row = n_constant_rows_;
    n_constant_rows_ += u32(term->size() * term->stencil());
    blocks.push_back({term->sites(), term->first_row});
    term_chunks_.emplace_back(device, system.n_worlds());
    term_chunks_.back().set(ranges(term->world_first()));
    most_elements = std::max(most_elements, term->size());
  }
  constant_gather_.set(blocks);
  element_energy_.resize(most_elements);
  rows_.resize(3 * n_constant_rows_);
  preconditioner_ = std::make_unique<GroupPreconditioner>(system.sites, system.node_group, system.group_world.size(),
                                                          constant_, system.contact_couplings);
}

void Potential::update_sites(Positions& positions) {
  nodes_to_sites_(system_.sites.size(), u32(system_.sites.size()), sites_, positions.node, positions.site);
}

void Potential::begin_step(const Positions& start, const Positions& predicted, double h, double inertia_h) {
  start_ = &start;
  predicted_ = &predicted;
  h_ = h;
  inertia_h_ = inertia_h;
}

void Potential::update_joints(const System& system) {
  revolute_.update(system.revolute_drive.rows);
  prismatic_.update(system.prismatic_drive.rows);
  revolute_limit_.update(system.revolute_limit.rows);
}

void Potential::set_friction(const WorldRows<Friction>& rows) {
  friction_.set(rows.rows.read(0, rows.n()), rows.first);
  friction_chunks_.set(ranges(rows.first));
}

const Buffer<f64>& Potential::origin(const Term& term) const {
  return is_inertia(term) ? predicted_->site : start_->site;
}

std::vector<double> Potential::energy(const Positions& x, const WorldRows<Barrier>& candidates) {
  std::vector<double> total(system_.n_worlds(), 0);
  const auto add = [&](const WorldChunks& chunks) {
    reduce_.sum(chunks, element_energy_, world_energy_);
    const std::vector<double> part = world_energy_.read();
    for (std::size_t w = 0; w < total.size(); ++w) total[w] += part[w];
  };
  element_energy_.resize(std::max<std::size_t>({element_energy_.size(), candidates.n(), friction_.size()}));
  for (std::size_t t = 0; t < constant_.size(); ++t) {
    if (constant_[t]->size() == 0) continue;
    constant_[t]->energy(x.site, origin(*constant_[t]), step_length(*constant_[t]), element_energy_);
    add(term_chunks_[t]);
  }
  if (friction_.size() > 0) {
    friction_.energy(x.site, start_->site, h_, element_energy_);
    add(friction_chunks_);
  }
  if (candidates.n() > 0) {
    candidate_chunks_.set(ranges(candidates.first));
    barrier_.energy_over(candidates.rows, candidates.n(), x.site, start_->site, h_, element_energy_);
    add(candidate_chunks_);
  }
  return total;
}

void Potential::set_contacts(const WorldRows<Barrier>& contacts) {
  barrier_.set(contacts.rows.read(0, contacts.n()), contacts.first);
  barrier_.first_row = n_constant_rows_;
  friction_.first_row = u32(n_constant_rows_ + barrier_.size() * barrier_.stencil());
  const std::size_t n_rows = friction_.first_row + friction_.size() * friction_.stencil();
  if (3 * n_rows > rows_.size()) rows_.resize(3 * n_rows);
  const RowBlock blocks[] = {{barrier_.sites(), barrier_.first_row}, {friction_.sites(), friction_.first_row}};
  contact_gather_.set(blocks);
}

void Potential::gather(Buffer<f64>& node) {
  constant_gather_.apply(gather_rows_, node_is_fixed_, rows_, false, node);
  if (barrier_.size() + friction_.size() > 0) contact_gather_.apply(gather_rows_, node_is_fixed_, rows_, true, node);
}

void Potential::differentiate(const Positions& x, const WorldRows<Barrier>& contacts, Buffer<f64>& gradient) {
  set_contacts(contacts);
  for (Term* term : all_) {
    term->gradient(x.site, origin(*term), step_length(*term), rows_);
    term->hessian(x.site, origin(*term), step_length(*term));
  }
  gather(gradient);
}

void Potential::product(const Buffer<f64>& direction, Buffer<f64>& out) {
  nodes_to_sites_(system_.sites.size(), u32(system_.sites.size()), sites_, direction, direction_site_);
  for (Term* term : all_) term->product(direction_site_, rows_);
  gather(out);
}

std::optional<std::size_t> Potential::factorize(std::span<const char> world_is_active) {
  std::vector<char> group_is_active;
  for (const u32 world : system_.group_world) group_is_active.push_back(world_is_active[world]);
  const std::vector<double> barrier = barrier_.blocks().read(), friction = friction_.blocks().read();
  const ElementBlocks contacts[] = {{4, barrier_.sites(), barrier}, {4, friction_.sites(), friction}};
  const std::size_t failed = preconditioner_->factorize(constant_, contacts, group_is_active);
  if (failed == preconditioner_->n_groups()) return std::nullopt;
  return failed;
}

}  // namespace pvg
