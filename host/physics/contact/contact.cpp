#include "host/physics/contact/contact.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "contact/report.h"
#include "host/physics/contact/continuous_collision.hpp"

namespace pvg {
namespace {

Vec3 vec3(const double* values) { return {values[0], values[1], values[2]}; }

std::vector<double> flatten(std::span<const Vec3> x) {
  std::vector<double> values;
  for (const Vec3& point : x) values.insert(values.end(), {point[0], point[1], point[2]});
  return values;
}

void check_settings(const CollisionMesh& mesh, std::span<const ContactSettings> settings) {
  if (settings.size() != mesh.n_worlds) throw std::logic_error("contact settings are needed for each world");
  for (const ContactSettings& s : settings)
    if (!(s.activation_distance > 0) || !(s.stiffness > 0) || !(s.friction_velocity > 0))
      throw UsageError("contact: activation distance, stiffness and friction velocity must be positive");
}

}  // namespace

struct ContactSet::Impl {
  Device& device;
  CollisionMesh mesh;
  Candidates candidates;
  ContinuousCollision collision;
  Program program, list_program;
  Kernel pair_gaps, fill_contacts, sum_and_list, report_contacts;
  WorldMinimum minimum;
  WorldRows<Barrier> contacts;
  LaggedFriction friction;
  Buffer<double> gaps;                   // [n_candidates, m]
  Buffer<u32> is_active, active_counts;  // [n_candidates], of each 64 of them
  Buffer<u32> first;                     // [n_worlds + 1] contacts of each world
  Buffer<u32> sites;                     // [n_candidates x 4] of contacts
  std::vector<u32> contact_sites;        // on the host
  bool reads_sites = true;               // to the host, ahead
  Buffer<u32> changed;                   // [1]
  u32 search = 0, last_change = 0, read_change = 0;
  u32 read_search = 0, known_search = 0;  // whose sites are read ahead; whose contact_sites are
  std::size_t sites_serial = 0;           // of the memory of `sites`
  std::vector<u32> foreseen_first;
  std::size_t foreseen_room = 0;
  u32 foreseen_search = 0;
  bool is_foreseen = false;
  std::size_t n_contacts_before = 0;
  Buffer<ContactReport> reports;  // [n_contacts]

  Impl(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings, std::span<const Vec3> x,
       Margins margins)
      : device(device),
        mesh(mesh),
        candidates(device, mesh, settings, x, margins.usual, margins.least),
        collision(device),
        program(device, "contact/contact.cl"),
        list_program(device, "contact/sum_and_list.cl"),
        pair_gaps(program.kernel("pair_gaps")),
        fill_contacts(program.kernel("fill_contacts")),
        sum_and_list(list_program.kernel("sum_and_list")),
        report_contacts(program.kernel("report_contacts")),
        minimum(device),
        contacts{Buffer<Barrier>(device, 0, "contacts"), std::vector<u32>(mesh.n_worlds + 1, 0)},
        friction(device, this->mesh),
        gaps(device, 0, "candidate_gaps"),
        is_active(device, 0, "candidate_is_active"),
        active_counts(device, 0, "active_counts"),
        first(device, mesh.n_worlds + 1, "first_contact_of_world"),
        sites(device, 0, "contact_sites"),
        changed(device, 1, "changed"),
        reports(device, 0, "contact_reports") {
    changed.zero();
  }

  // to those that are here
  void read_further_sites() {
    const std::size_t n = 4 * contacts.n(), n_read = std::min(n, contact_sites.size());
    contact_sites.resize(n);
    if (n > n_read) sites.read(n_read, std::span(contact_sites).subspan(n_read));
    known_search = search;
  }

  void resize_activity() {
    is_active.resize(candidates.rows().n());
    active_counts.resize((candidates.rows().n() + GROUP_SIZE - 1) / GROUP_SIZE);
  }

  void measure_gaps(const Buffer<double>& x) {
    const WorldRows<Barrier>& pairs = candidates.rows();
    gaps.resize(pairs.n());
    resize_activity();
    pair_gaps(pairs.n(), pairs.n(), pairs.rows, x, gaps, is_active, active_counts);
  }

  // for contacts: mostly there are not many more than last time
  std::size_t usual_room() const { return n_contacts_before + n_contacts_before / 4 + 16; }

  // before candidates are listed as contacts, and after it
  void begin_list() {
    const u32 n = candidates.rows().n();
    contacts.rows.resize(n);
    sites.resize(4 * std::size_t(n));
    ++search;
    if (const std::size_t serial = sites.memory().serial(); n > 0 && serial != sites_serial) {
      sites_serial = serial;  // what stands there now says nothing
      last_change = search;
    }
  }
  void read_list() {
    first.read_later(0, std::span(contacts.first));
    changed.read_later(0, std::span(&read_change, 1));
    if (!reads_sites) return;
    contact_sites.resize(std::min(sites.size(), 4 * usual_room()));
    sites.read_later(0, std::span(contact_sites));
    read_search = search;
    known_search = 0;
  }
};

ContactSet::ContactSet(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
                       std::span<const Vec3> x, double correction) {
  check_settings(mesh, settings);
  check_collision_mesh(mesh, x.size());
  impl_ = std::make_unique<Impl>(device, mesh, settings, x, margins_of(device, settings, correction));
}
ContactSet::~ContactSet() = default;
ContactSet::ContactSet(ContactSet&&) noexcept = default;

const WorldRows<Barrier>& ContactSet::candidates() const { return impl_->candidates.rows(); }
const WorldRows<Barrier>& ContactSet::contacts() const { return impl_->contacts; }
const WorldRows<Friction>& ContactSet::friction() const { return impl_->friction.rows(); }
LaggedFriction& ContactSet::lagged() { return impl_->friction; }
const LaggedFriction& ContactSet::lagged() const { return impl_->friction; }

void ContactSet::find_candidates(const Buffer<double>& x0, const Buffer<double>& x1) { impl_->candidates.find(x0, x1); }

std::vector<double> ContactSet::largest_step(const Buffer<double>& x0, const Buffer<double>& x1) {
  return impl_->collision.largest_step(impl_->candidates.rows(), x0, x1);
}

void ContactSet::start_check(const Buffer<double>& x0, const Buffer<double>& x1) {
  impl_->candidates.start_check(x0, x1);
}
void ContactSet::defer_check() { impl_->candidates.defer_check(); }
bool ContactSet::candidates_serve() const { return impl_->candidates.serve(); }
Candidates::Lists ContactSet::renew_candidates(const Buffer<double>& x0, const Buffer<double>& x1) {
  return impl_->candidates.renew(x0, x1);
}
void ContactSet::start_renew_candidates(const Buffer<double>& x0, const Buffer<double>& x1,
                                        const Candidates::Lists& which) {
  impl_->candidates.start_renew(x0, x1, which);
}
Candidates::Lists ContactSet::lacking_candidates() const { return impl_->candidates.lacking(); }

void ContactSet::foresee() {
  Impl& impl = *impl_;
  impl.candidates.foresee();
  impl.is_foreseen = true;
  if (impl.contacts.rows.size() == 0) impl.contacts.first.assign(impl.mesh.n_worlds + 1, 0);
  impl.foreseen_first.resize(impl.contacts.first.size());
  std::swap(impl.contacts.first, impl.foreseen_first);  // where the device writes to
  impl.foreseen_search = impl.search;
  // where nothing touched nothing is thought to touch, which takes fewer launches
  impl.foreseen_room = impl.n_contacts_before > 0 ? std::min(impl.contacts.rows.size(), impl.usual_room()) : 0;
  impl.contacts.rows.resize(impl.foreseen_room);
  impl.contacts.first.back() = u32(impl.foreseen_room);
}

bool ContactSet::is_foreseen() const { return impl_->is_foreseen; }
bool ContactSet::take_foreseen() {
  Impl& impl = *impl_;
  const std::size_t n = impl.foreseen_first.back();
  impl.is_foreseen = false;
  if (!impl.candidates.take_foreseen() || n > impl.foreseen_room) return false;
  if (impl.read_search != impl.foreseen_search || 4 * n > impl.contact_sites.size()) return true;
  impl.contact_sites.resize(4 * n);
  impl.known_search = impl.foreseen_search;
  return true;
}

const std::vector<u32>& ContactSet::foreseen_first() const { return impl_->foreseen_first; }
std::vector<u32> ContactSet::foreseen_sites() const {
  return impl_->known_search == impl_->foreseen_search ? impl_->contact_sites : std::vector<u32>();
}
const Candidates::Lists& ContactSet::lacked_candidates() const { return impl_->candidates.lacked(); }
u32 ContactSet::n_worlds() const { return impl_->mesh.n_worlds; }

const Buffer<double>& ContactSet::start_largest_steps(const Buffer<double>& x0, const Buffer<double>& x1) {
  Impl& impl = *impl_;
  if (!impl.candidates.is_check_deferred()) return impl.collision.start(impl.candidates.rows(), x0, x1);
  Buffer<double>& steps = impl.collision.steps(impl.candidates.rows().n());
  impl.candidates.start_certify(x0, x1, steps, impl.collision.of_64());
  return steps;
}
const Buffer<double>& ContactSet::least_of_64_steps() const { return impl_->collision.of_64(); }
const Buffer<u32>& ContactSet::first_candidate() const { return impl_->candidates.first(); }

Buffer<u32>& ContactSet::activity() {
  impl_->resize_activity();
  return impl_->is_active;
}
Buffer<u32>& ContactSet::activity_counts() {
  impl_->resize_activity();
  return impl_->active_counts;
}

void ContactSet::start_find_contacts(const Buffer<double>& x) {
  if (candidates().n() > 0) impl_->measure_gaps(x);
  start_list_contacts();
}

void ContactSet::start_list_contacts() {
  Impl& impl = *impl_;
  const WorldRows<Barrier>& candidates = impl.candidates.rows();
  impl.begin_list();
  if (candidates.n() == 0) {
    impl.first.zero();
    return;
  }
  const u32 n = candidates.n();
  impl.fill_contacts(n, n, impl.mesh.n_worlds, candidates.rows, impl.is_active, impl.active_counts,
                     impl.candidates.first(), impl.first, impl.contacts.rows, impl.sites, impl.search, impl.changed);
  impl.read_list();
}

void ContactSet::start_list_contacts(const EnergySum& sum) {
  Impl& impl = *impl_;
  const WorldRows<Barrier>& candidates = impl.candidates.rows();
  impl.begin_list();
  const u32 n_worlds = impl.mesh.n_worlds, n = u32(GROUP_SIZE) * n_worlds + candidates.n();
  const u32 most = WorldReduce::n_late_chunks(candidates.n());
  impl.sum_and_list(n, n, n_worlds, u32(sum.chunks.has_large_world()), sum.chunks.first(), sum.chunks.chunks(),
                    sum.element, sum.chunks.partial(), most, sum.from, sum.late_partial, sum.world, candidates.rows,
                    impl.is_active, impl.active_counts, impl.candidates.first(), impl.first, impl.contacts.rows,
                    impl.sites, impl.search, impl.changed);
  impl.read_list();
}

void ContactSet::take_contacts() {
  Impl& impl = *impl_;
  if (impl.contacts.rows.size() == 0) impl.contacts.first.assign(impl.mesh.n_worlds + 1, 0);
  const std::size_t n = impl.contacts.n();
  impl.n_contacts_before = n;
  impl.contacts.rows.resize(n);
  impl.last_change = std::max(impl.last_change, impl.read_change);
  if (impl.read_search == impl.search) impl.read_further_sites();
}

void ContactSet::read_sites(bool wanted) { impl_->reads_sites = wanted; }
const Buffer<u32>& ContactSet::sites_on_device() const { return impl_->sites; }
u32 ContactSet::search() const { return impl_->search; }
u32 ContactSet::last_change() const { return impl_->last_change; }
const Buffer<u32>& ContactSet::first_contact() const { return impl_->first; }
const std::vector<u32>& ContactSet::contact_sites() const {
  Impl& impl = *impl_;
  if (impl.known_search < impl.last_change || impl.contact_sites.size() != 4 * impl.contacts.n()) {
    impl.contact_sites.clear();
    impl.read_further_sites();
  }
  return impl.contact_sites;
}

void ContactSet::find_contacts(const Buffer<double>& x) {
  start_find_contacts(x);
  impl_->device.finish();
  take_contacts();
}
// rows of what contacts.rows has: of contacts, or, where these are not taken yet, of all candidates
void ContactSet::start_lag_friction(const Buffer<double>& x) {
  impl_->friction.start(impl_->contacts, impl_->first, impl_->candidates.worlds(), x, impl_->usual_room());
}
void ContactSet::take_friction(double h, const Buffer<double>& x0, const Buffer<double>& x1) {
  impl_->friction.take(impl_->contacts.first, h, x0, x1);
}

void ContactSet::lag_friction(const Buffer<double>& x, double h, const Buffer<double>& x0, const Buffer<double>& x1) {
  start_lag_friction(x);
  impl_->device.finish();
  take_friction(h, x0, x1);
}

void ContactSet::find_and_lag_friction(const Buffer<double>& x, double h, const Buffer<double>& x0,
                                       const Buffer<double>& x1) {
  start_find_contacts(x);
  start_lag_friction(x);
  impl_->device.finish();
  take_contacts();
  take_friction(h, x0, x1);
}

std::vector<double> ContactSet::min_gap(const Buffer<double>& x) {
  impl_->measure_gaps(x);
  return impl_->minimum(impl_->candidates.rows().first, impl_->gaps, INFINITY);
}

std::vector<std::vector<ContactForce>> ContactSet::forces(const Buffer<double>& x, const Buffer<double>& x0, double h) {
  Impl& impl = *impl_;
  const u32 n = impl.contacts.n();
  impl.reports.resize(n);
  impl.report_contacts(n, n, impl.contacts.rows, x, impl.reports);
  const std::vector<ContactReport> reports = impl.reports.read();
  const std::vector<Barrier> contacts = impl.contacts.rows.read();
  const std::map<PairKey, Vec3> sliding = impl.friction.forces(x, x0, h);
  std::vector<std::vector<ContactForce>> worlds(impl.mesh.n_worlds);
  for (u32 i = 0; i < n; ++i) {
    ContactForce force;
    force.kind = ContactForce::Kind(contacts[i].kind);
    force.first = int(contacts[i].body[0]);
    force.second = int(contacts[i].body[1]);
    force.point = vec3(reports[i].point);
    force.normal = vec3(reports[i].normal);
    force.gap = reports[i].gap;
    force.normal_force = reports[i].normal_force;
    if (const auto found = sliding.find(pair_key(contacts[i])); found != sliding.end())
      force.friction_force = found->second;
    worlds[contacts[i].world].push_back(force);
  }
  return worlds;
}

std::optional<StartConflict> ContactSet::find_start_conflict(std::span<const Vec3> x) {
  Impl& impl = *impl_;
  if (auto conflict = find_surface_intersection(impl.mesh, x)) return conflict;
  if (auto conflict = find_enclosed_body(impl.mesh, x)) return conflict;
  const Buffer<double> on_device(impl.device, flatten(x), "start_sites");
  find_candidates(on_device, on_device);
  impl.measure_gaps(on_device);
  const std::vector<double> gaps = impl.gaps.read();
  for (std::size_t i = 0; i < gaps.size(); ++i)
    if (!(gaps[i] > 0)) {
      const Barrier row = impl.candidates.rows().rows.read(i, 1).front();
      const u32 second = row.kind == EDGE_EDGE ? row.site[2] : row.site[1];
      const bool is_below = row.kind == POINT_PLANE && !(gaps[i] > -row.offset);
      return StartConflict{row.world, row.body[0], row.body[1], row.site[0], second, is_below, gaps[i]};
    }
  return std::nullopt;
}

}  // namespace pvg
