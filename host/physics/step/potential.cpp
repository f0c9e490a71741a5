#include "host/physics/step/potential.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

namespace pvg {
namespace {

u32 whole_groups(u32 n) { return u32((n + GROUP_SIZE - 1) / GROUP_SIZE * GROUP_SIZE); }

// appends the runs of each world in a list of elements, the first of which has the number `offset`
void append_ranges(const std::vector<u32>& world_first, u32 offset, std::vector<WorldRange>& ranges) {
  for (u32 w = 0; w + 1 < world_first.size(); ++w)
    if (world_first[w] < world_first[w + 1])
      ranges.push_back({w, offset + world_first[w], offset + world_first[w + 1]});
}

}  // namespace

Potential::Potential(Device& device, const System& system)
    : system_(system),
      nodes_program_(device, "solve/nodes.cl"),
      nodes_to_sites_(nodes_program_.kernel("nodes_to_sites")),
      gather_rows_(nodes_program_.kernel("gather_rows")),
      gather_two_lists_(nodes_program_.kernel("gather_two_lists")),
      product_of_contacts_(nodes_program_.kernel("product_of_contacts")),
      sites_(device, system.sites, "sites"),
      node_is_fixed_(device, system.node_is_fixed, "is_fixed"),
      terms_(device, system),
      barrier_(device, "contact", "barrier", 4),
      friction_(device, "contact", "friction", 4),
      friction_dual_(device, 0, "friction dual"),
      flows_4_(device, system.plastic_flow_4, "plastic_flow_4"),
      flows_10_(device, system.plastic_flow_10, "plastic_flow_10"),
      world_steps_(device, system.n_worlds(), "world steps"),
      constant_(terms_.all()),
      constant_gather_(device, system.sites, system.n_nodes()),
      contact_gather_(device, system.sites, system.n_nodes()),
      chunks_(device, system.n_worlds(), GROUP_SIZE),
      contact_sites_(device, 0, "element_sites"),
      rows_(device, 0, "rows"),
      element_energy_(device, 0, "energy"),
      world_energy_(device, system.n_worlds(), "world energy"),
      direction_site_(device, 3 * system.sites.size(), "direction sites"),
      reduce_(device, system.n_worlds()),
      energy_chunks_(device, system.n_worlds()) {
  if (!system.force_law.empty()) force_laws_.emplace(device, system);
  if (flows_4_.size() + flows_10_.size() > 0) {
    Program program(device, "energies/elastic/plastic_flow.cl");
    flow_4_.emplace(program.kernel("plastic_flow_4"));
    flow_10_.emplace(program.kernel("plastic_flow_10"));
  }
  std::vector<RowBlock> blocks;
  first_energy_.push_back(0);
  for (Term* term : constant_) {
    term->first_row = n_constant_rows_;
    n_constant_rows_ += u32(term->size() * term->stencil());
    blocks.push_back({term->sites(), term->first_row});
    append_ranges(term->world_first(), first_energy_.back(), energy_ranges_);
    first_energy_.push_back(u32(first_energy_.back() + term->size()));
  }
  constant_gather_.set(blocks);
  rows_.resize(3 * n_constant_rows_);
  matrix_ = std::make_unique<BlockMatrix>(device, system.sites, system.node_is_fixed, constant_, system.node_ranges);
  std::vector<SmallTermSource> small = terms_.small(device, system, first_energy_);
  for (std::size_t t = 0; t < constant_.size(); ++t)
    if (constant_[t]->size() > 0 &&
        std::none_of(small.begin(), small.end(), [&](const SmallTermSource& s) { return s.term == constant_[t]; }))
      large_.push_back(t);
  small_terms_.emplace(device, std::move(small), law_cases("JOINT_LAWS", system.joint_laws));
  preconditioner_ = std::make_unique<Preconditioner>(device, system, *matrix_);
  chunks_.set(system.node_ranges);
  couplings_.resize(system.n_worlds());
}

void Potential::update_sites(Positions& positions) { to_sites(positions.node, positions.site); }

void Potential::begin_step(const Positions& start, const Positions& predicted, double h, double inertia_h) {
  start_ = &start;
  predicted_ = &predicted;
  h_ = h;
  inertia_h_ = inertia_h;
}

void Potential::update_joints(const System& system) {
  terms_.revolute_drive.update(system.revolute_drive.rows);
  terms_.prismatic_drive.update(system.prismatic_drive.rows);
  terms_.revolute_limit.update(system.revolute_limit.rows);
  terms_.revolute_effect.update(system.revolute_effect.rows);
  terms_.prismatic_effect.update(system.prismatic_effect.rows);
  terms_.revolute_law.update(system.revolute_law.rows);
  terms_.prismatic_law.update(system.prismatic_law.rows);
}

void Potential::update_spin(const System& system) { terms_.spin.update(system.spin.rows); }

void Potential::update_forces(const System& system) { terms_.point_force.update(system.point_force.rows); }

void Potential::set_forces(const Buffer<f64>& v) {
  if (!force_laws_) return;
  to_sites(v, direction_site_);
  force_laws_->write(terms_.point_force.params(), start_->site, direction_site_, h_);
}

void Potential::flow(const Positions& x, double h, std::span<const char> worlds) {
  if (flows_4_.size() + flows_10_.size() == 0) return;
  world_steps_.write(std::vector<u32>(worlds.begin(), worlds.end()));
  const auto run = [&](Kernel& kernel, const Buffer<PlasticFlow>& flows, Term& term) {
    kernel(flows.size(), u32(flows.size()), flows, term.params(), world_steps_, x.site, h);
  };
  run(*flow_4_, flows_4_, terms_.stable_neo_hookean_4);
  run(*flow_10_, flows_10_, terms_.stable_neo_hookean_10);
}

namespace {

// Carries rest_inverse between the elements that flow and a list of numbers, from number `at` on; either way.
template <class Element, class Carry>
void for_each_flow(Term& term, const std::vector<PlasticFlow>& flows, std::size_t& at, const Carry& carry) {
  for (const PlasticFlow& flow : flows) {
    const std::size_t place = flow.element * sizeof(Element) + offsetof(Element, rest_inverse);
    carry(term.params(), place, at);
    at += 9;
  }
}

}  // namespace

std::vector<double> Potential::flowed() {
  std::vector<double> values(9 * (flows_4_.size() + flows_10_.size()));
  const auto read = [&](Buffer<unsigned char>& params, std::size_t place, std::size_t at) {
    const std::vector<unsigned char> bytes = params.read(place, 9 * sizeof(double));
    std::memcpy(&values[at], bytes.data(), bytes.size());
  };
  std::size_t at = 0;
  for_each_flow<StableNeoHookean4>(terms_.stable_neo_hookean_4, system_.plastic_flow_4, at, read);
  for_each_flow<StableNeoHookean10>(terms_.stable_neo_hookean_10, system_.plastic_flow_10, at, read);
  return values;
}

void Potential::restore_flowed(const std::vector<double>& values) {
  const auto write = [&](Buffer<unsigned char>& params, std::size_t place, std::size_t at) {
    const auto* first = reinterpret_cast<const unsigned char*>(&values[at]);
    params.write(place, std::vector<unsigned char>(first, first + 9 * sizeof(double)));
  };
  std::size_t at = 0;
  for_each_flow<StableNeoHookean4>(terms_.stable_neo_hookean_4, system_.plastic_flow_4, at, write);
  for_each_flow<StableNeoHookean10>(terms_.stable_neo_hookean_10, system_.plastic_flow_10, at, write);
}

Potential::ContactKernels::ContactKernels(Device& device)
    : program(device, "energies/contact/contact_terms.cl"),
      energy(program.kernel("contact_energy")),
      derivatives(program.kernel("contact_derivatives")) {}

Potential::ContactKernels& Potential::contact_kernels() {
  if (!contact_kernels_) contact_kernels_.emplace(rows_.memory().device());
  return *contact_kernels_;
}

void Potential::set_friction(const ContactSet& contacts) {
  friction_.set_sites(contacts.lagged().sites(), contacts.friction().first);
  friction_dual_.resize(friction_.size());
  friction_is_new_ = true;
}

void Potential::to_sites(const Buffer<f64>& node, Buffer<f64>& value) {
  nodes_to_sites_(system_.sites.size(), u32(system_.sites.size()), sites_, node, value);
}

// Contact in one launch with a scene's small terms, whose program then takes longer to compile. On the host's own
// processor a launch takes less than the larger kernel.
bool Potential::launches_together() const {
  return !rows_.memory().device().info().runs_host_functions && !small_terms_->is_empty();
}

const Buffer<f64>& Potential::origin(const Term& term) const {
  return is_inertia(term) ? predicted_->site : start_->site;
}

const Buffer<f64>& Potential::start_energy(const Positions& x, ContactSet& contacts, bool defers_sum) {
  const u32 first_friction = first_energy_.back(), n_friction = u32(friction_.size());
  const u32 n_candidates = contacts.candidates().n();
  element_energy_.resize(first_friction + n_friction + n_candidates);
  const SmallTerms::At at{x.site, start_->site, predicted_->site, h_, inertia_h_};
  const u32 n = whole_groups(n_friction) + n_candidates;
  const bool is_together = n > 0 && launches_together();
  if (is_together)
    small_terms_->energy(at, element_energy_, n, n_friction, first_friction, contacts);
  else
    small_terms_->energy(at, element_energy_);
  for (const std::size_t t : large_)
    constant_[t]->energy(x.site, origin(*constant_[t]), step_length(*constant_[t]), first_energy_[t], element_energy_);
  if (n > 0 && !is_together)
    contact_kernels().energy(n, n, n_friction, contacts.friction().rows, contacts.candidates().rows, x.site,
                             start_->site, h_, first_friction, element_energy_, contacts.activity(),
                             contacts.activity_counts());
  std::vector<WorldRange> ranges = energy_ranges_;
  append_ranges(friction_.world_first(), first_friction, ranges);
  energy_chunks_.set(ranges);
  defers_sum_ = defers_sum && n_candidates > 0;
  if (defers_sum_) return world_energy_;
  reduce_.sum(energy_chunks_, element_energy_, first_friction + n_friction, contacts.first_candidate(), n_candidates,
              world_energy_);
  return world_energy_;
}

void Potential::start_list_contacts(ContactSet& contacts) {
  if (!std::exchange(defers_sum_, false)) return contacts.start_list_contacts();
  reduce_.start_chunks(energy_chunks_, element_energy_);
  contacts.start_list_contacts({energy_chunks_, element_energy_, u32(first_energy_.back() + friction_.size()),
                                reduce_.late_partial(contacts.candidates().n()), world_energy_});
}

std::vector<double> Potential::energy(const Positions& x, ContactSet& contacts) {
  return start_energy(x, contacts).read();
}

// On a device apart from the host, with its factor there, the host knows only how many contacts there are, unless pairs
// in contact are in the factor.
bool Potential::reads_contacts() const {
  return rows_.memory().device().info().runs_host_functions || preconditioner_->reads_contacts() ||
         std::any_of(couplings_.begin(), couplings_.end(), [](const auto& pairs) { return !pairs.empty(); });
}

void Potential::set_contacts(const ContactSet& contacts) {
  const std::vector<u32>& first = contacts.contacts().first;
  const bool lists_on_device = can_foresee_contacts(), is_listed = lists_on_device && has_listed(contacts);
  if (!lists_on_device)
    barrier_.set_sites(contacts.contact_sites(), first);
  else if (!is_listed)
    barrier_.set_size(first.back(), first);
  if (lists_on_device && !contacts.is_foreseen())
    barrier_.know(reads_contacts() ? contacts.contact_sites() : std::vector<u32>(), first);
  if (is_listed || !has_contacts()) return;
  barrier_.first_row = n_constant_rows_;
  friction_.first_row = u32(n_constant_rows_ + barrier_.size() * barrier_.stencil());
  const std::size_t n_rows = friction_.first_row + friction_.size() * friction_.stencil();
  if (3 * n_rows > rows_.size()) rows_.resize(3 * n_rows);
  if (lists_on_device) return list_contacts_on_device(contacts);
  std::vector<u32> sites = barrier_.sites();
  sites.insert(sites.end(), friction_.sites().begin(), friction_.sites().end());
  // late iterations of Newton's method mostly keep the contacts
  if (sites == gathered_sites_ && barrier_.size() == n_gathered_contacts_) return;
  gathered_sites_ = sites;
  n_gathered_contacts_ = barrier_.size();
  const RowBlock blocks[] = {{barrier_.sites(), barrier_.first_row}, {friction_.sites(), friction_.first_row}};
  contact_gather_.set(blocks);
  contact_sites_.resize(sites.size());
  contact_sites_.write(sites);
}

// Where there was room for more contacts than there are, it is left.
bool Potential::has_listed(const ContactSet& contacts) const {
  return !contacts.is_foreseen() && n_gathered_contacts_ == contacts.contacts().n() &&
         contacts.last_change() <= gathered_search_ && gathered_sites_ == friction_.sites() && gathered_search_ > 0;
}

void Potential::list_contacts_on_device(const ContactSet& contacts) {
  n_gathered_contacts_ = barrier_.size();
  gathered_search_ = contacts.is_foreseen() ? 0 : contacts.search();
  foreseen_search_ = contacts.is_foreseen() ? contacts.search() : 0;
  gathered_sites_ = friction_.sites();
  contact_gather_.set_on_device({contacts.sites_on_device(), u32(barrier_.size()), contacts.first_contact()},
                                {contacts.lagged().sites_on_device(), u32(friction_.size()), contacts.lagged().first()},
                                n_constant_rows_, sites_, chunks_, contact_sites_);
}

bool Potential::can_foresee_contacts() const {
  return !rows_.memory().device().info().runs_host_functions && !preconditioner_->reads_contacts();
}

bool Potential::take_foreseen(const ContactSet& contacts, std::span<const char> once_coupled) {
  barrier_.know(contacts.foreseen_sites(), contacts.foreseen_first());
  if (foreseen_search_ > 0) {
    n_gathered_contacts_ = contacts.foreseen_first().back();
    gathered_search_ = std::exchange(foreseen_search_, 0);
  }
  return next_couplings(once_coupled, Coupling::step_begins) == couplings_;
}

bool Potential::differentiate(const Positions& x, const ContactSet& contacts, Buffer<f64>& gradient,
                              std::span<const char> worlds, Buffer<f64>* dx, Buffer<f64>* residual) {
  set_contacts(contacts);
  return differentiate(x, &contacts, gradient, worlds, dx, residual);
}

void Potential::differentiate(const Positions& x, Buffer<f64>& gradient) {
  differentiate(x, nullptr, gradient, {}, nullptr, nullptr);
}

bool Potential::differentiate(const Positions& x, const ContactSet* contacts, Buffer<f64>& gradient,
                              std::span<const char> worlds, Buffer<f64>* dx, Buffer<f64>* residual) {
  const SmallTerms::At at{x.site, start_->site, predicted_->site, h_, inertia_h_};
  const u32 n_friction = u32(friction_.size()), n_contacts = u32(barrier_.size());
  const u32 n_items = whole_groups(n_friction) + n_contacts;
  const bool is_together = has_contacts() && launches_together();
  if (is_together)
    small_terms_->differentiate(at, rows_, matrix_->element_blocks(), n_items, *contacts, barrier_, friction_,
                                std::exchange(friction_is_new_, false), friction_dual_);
  else
    small_terms_->differentiate(at, rows_, matrix_->element_blocks());
  const auto differentiate = [&](Term& term) {
    term.gradient(x.site, origin(term), step_length(term), rows_);
    term.hessian(x.site, origin(term), step_length(term), worlds);
  };
  for (const std::size_t t : large_) differentiate(*constant_[t]);
  if (has_contacts() && !is_together)
    contact_kernels().derivatives(n_items, n_items, n_friction, n_contacts, contacts->friction().rows,
                                  contacts->n_worlds(), contacts->first_contact(), contacts->contacts().rows, x.site,
                                  start_->site, h_, barrier_.first_row, rows_, barrier_.own_blocks(),
                                  friction_.own_blocks(), u32(std::exchange(friction_is_new_, false)), friction_dual_);
  const u32 n = u32(system_.n_nodes());
  if (is_together && worlds.empty() && dx && residual) {
    matrix_->assemble_and_gather(constant_gather_, contact_gather_, node_is_fixed_, rows_, gradient, *dx, *residual);
    return true;
  }
  matrix_->assemble(worlds);
  if (!has_contacts()) {
    constant_gather_.apply(gather_rows_, node_is_fixed_, rows_, false, gradient);
    return false;
  }
  if (!(dx && residual) && !unused_) unused_.emplace(rows_.memory().device(), gradient.size(), "unused");
  gather_two_lists_(n, n, constant_gather_.offset(), constant_gather_.row(), constant_gather_.weight(),
                    contact_gather_.offset(), contact_gather_.row(), contact_gather_.weight(), node_is_fixed_, rows_,
                    gradient, dx ? *dx : *unused_, residual ? *residual : *unused_);
  return dx && residual;
}

void Potential::product(const Buffer<f64>& direction, Buffer<f64>& out) {
  if (!has_contacts()) return matrix_->multiply(direction, out);
  const u32 n = u32(barrier_.size() + friction_.size());
  product_of_contacts_(n, n, u32(barrier_.size()), contact_sites_, sites_, barrier_.blocks(), friction_.blocks(),
                       direction, n_constant_rows_, rows_);
  matrix_->multiply(direction, out);
  contact_gather_.apply(gather_rows_, node_is_fixed_, rows_, true, out);
}

ContactElements Potential::contact_elements() {
  return {contact_terms_, n_constant_rows_, &contact_gather_, &contact_sites_, &sites_, &rows_};
}

CgOperators Potential::operators() {
  CgOperators operators;
  operators.product = [this](const Buffer<f64>& direction, Buffer<f64>& out, WorldChunks& chunks) {
    matrix_->multiply_and_dot(direction, has_contacts() ? &contact_gather_ : nullptr, node_is_fixed_, rows_, out,
                              chunks);
    return true;
  };
  operators.precondition = [this](const Buffer<f64>& residual, Buffer<f64>& out, WorldChunks& chunks) {
    return preconditioner_->apply(residual, out, chunks);
  };
  operators.elements = contact_elements();
  return operators;
}

void Potential::start_factorize(std::span<const char> world_is_active, const Buffer<f64>* gradient,
                                std::span<const char> world_keeps) {
  preconditioner_->start_factorize(contact_elements(), world_is_active, gradient, world_keeps);
}

std::optional<u32> Potential::factorize(std::span<const char> world_is_active) {
  start_factorize(world_is_active);
  rows_.memory().device().finish();
  return failed();
}

}  // namespace pvg
