#include "host/physics/contact/contact.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "contact/report.h"
#include "host/physics/contact/candidates.hpp"
#include "host/physics/contact/continuous_collision.hpp"
#include "host/physics/contact/slip_effects.hpp"
#include "host/physics/linear/scan.hpp"

namespace pvg {
namespace {

template <class Row>
std::span<Row> of_world(std::vector<Row>& rows, const std::vector<u32>& first, u32 world) {
  return std::span(rows).subspan(first[world], first[world + 1] - first[world]);
}

// How much farther than the activation distance candidates are looked for [m]: half of it, or as far as several last
// corrections of Newton's method lead. They then mostly serve for the whole step after its first guess.
double margin_of(std::span<const ContactSettings> settings, double correction) {
  double least = INFINITY;
  for (const ContactSettings& s : settings) least = std::min(least, s.activation_distance);
  return std::max(0.5 * least, 4 * correction);
}

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
  Program program, friction_program;
  Kernel pair_gaps, fill_contacts, lag_friction, report_contacts, friction_force, friction_strain;
  Scan scan;
  WorldMinimum minimum;
  WorldRows<Barrier> contacts;
  WorldRows<Friction> friction;
  Buffer<double> gaps;                               // [n_candidates, m]
  Buffer<u32> is_active, offsets;                    // [n_candidates], [n_candidates + 1]
  Buffer<u32> places;                                // [n_worlds + 1] first candidate of each world
  Buffer<ContactReport> reports;                     // [n_contacts]
  Buffer<double> forces, strains;                    // [n_friction x 3, N], [n_friction x 3]
  std::vector<std::vector<FrictionAnchor>> anchors;  // [n_worlds], each sorted by pair

  Impl(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings, std::span<const Vec3> x,
       double correction)
      : device(device),
        mesh(mesh),
        candidates(device, mesh, settings, x, margin_of(settings, correction)),
        collision(device),
        program(device, "contact/contact.cl"),
        friction_program(device, "energies/contact/friction.cl"),
        pair_gaps(program.kernel("pair_gaps")),
        fill_contacts(program.kernel("fill_contacts")),
        lag_friction(program.kernel("lag_friction")),
        report_contacts(program.kernel("report_contacts")),
        friction_force(friction_program.kernel("friction_force")),
        friction_strain(friction_program.kernel("friction_strain")),
        scan(device),
        minimum(device),
        contacts{Buffer<Barrier>(device, 0, "contacts"), std::vector<u32>(mesh.n_worlds + 1, 0)},
        friction{Buffer<Friction>(device, 0, "friction"), std::vector<u32>(mesh.n_worlds + 1, 0)},
        gaps(device, 0, "candidate_gaps"),
        is_active(device, 0, "candidate_is_active"),
        offsets(device, 0, "contact_offsets"),
        places(device, 0, "first_candidate_of_world"),
        reports(device, 0, "contact_reports"),
        forces(device, 0, "friction_forces"),
        strains(device, 0, "friction_strains"),
        anchors(mesh.n_worlds) {}

  void measure_gaps(const Buffer<double>& x) {
    const WorldRows<Barrier>& pairs = candidates.rows();
    gaps.resize(pairs.n());
    is_active.resize(pairs.n());
    pair_gaps(pairs.n(), pairs.n(), pairs.rows, x, gaps, is_active);
  }

  // what friction exerts on the first body of each row, by pair
  std::map<PairKey, Vec3> friction_forces(const std::vector<Friction>& rows, const Buffer<double>& x,
                                          const Buffer<double>& x0, double h) {
    forces.resize(3 * rows.size());
    friction_force(rows.size(), u32(rows.size()), friction.rows, x, x0, h, forces);
    const std::vector<double> values = forces.read();
    std::map<PairKey, Vec3> found;
    for (std::size_t i = 0; i < rows.size(); ++i) found[pair_key(rows[i])] = vec3(&values[3 * i]);
    return found;
  }
};

ContactSet::ContactSet(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
                       std::span<const Vec3> x, double correction) {
  check_settings(mesh, settings);
  check_collision_mesh(mesh, x.size());
  impl_ = std::make_unique<Impl>(device, mesh, settings, x, correction);
}
ContactSet::~ContactSet() = default;
ContactSet::ContactSet(ContactSet&&) noexcept = default;

const WorldRows<Barrier>& ContactSet::candidates() const { return impl_->candidates.rows(); }
const WorldRows<Barrier>& ContactSet::contacts() const { return impl_->contacts; }
const WorldRows<Friction>& ContactSet::friction() const { return impl_->friction; }

void ContactSet::find_candidates(const Buffer<double>& x0, const Buffer<double>& x1) { impl_->candidates.find(x0, x1); }

std::vector<double> ContactSet::largest_step(const Buffer<double>& x0, const Buffer<double>& x1) {
  return impl_->collision.largest_step(impl_->candidates.rows(), x0, x1);
}

void ContactSet::find_contacts(const Buffer<double>& x) {
  Impl& impl = *impl_;
  const WorldRows<Barrier>& candidates = impl.candidates.rows();
  if (candidates.n() == 0) {
    impl.contacts.first = candidates.first;
    impl.contacts.rows.resize(0);
    return;
  }
  impl.measure_gaps(x);
  impl.scan(candidates.n(), impl.is_active, impl.offsets);
  impl.places.resize(candidates.first.size());
  impl.places.write(candidates.first);
  impl.contacts.first = impl.scan.read_at(impl.offsets, impl.places);
  impl.contacts.rows.resize(impl.contacts.n());
  impl.fill_contacts(candidates.n(), candidates.n(), candidates.rows, impl.offsets, impl.contacts.rows);
}

void ContactSet::lag_friction(const Buffer<double>& x, double h, const Buffer<double>& x0, const Buffer<double>& x1) {
  Impl& impl = *impl_;
  impl.friction.first = impl.contacts.first;
  impl.friction.rows.resize(impl.contacts.n());
  impl.lag_friction(impl.contacts.n(), impl.contacts.n(), impl.contacts.rows, impl.candidates.worlds(), x,
                    impl.friction.rows);
  std::vector<Friction> rows = impl.friction.rows.read();
  for (u32 world = 0; world < impl.mesh.n_worlds; ++world)
    attach_anchors(impl.anchors[world], h, of_world(rows, impl.friction.first, world));
  if (!rows.empty() && std::any_of(impl.mesh.effects.begin(), impl.mesh.effects.end(), changes_friction))
    apply_slip_effects(impl.mesh.effects, x0.read(), x1.read(), h, rows);
  impl.friction.rows.write(rows);
}

void ContactSet::renew_anchors(const Buffer<double>& x, const Buffer<double>& x0, double h,
                               std::span<const char> worlds) {
  Impl& impl = *impl_;
  const u32 n = impl.friction.n();
  impl.strains.resize(3 * n);
  impl.friction_strain(n, n, impl.friction.rows, x, x0, h, impl.strains);
  std::vector<Friction> rows = impl.friction.rows.read();
  const std::vector<double> strains = impl.strains.read();
  for (u32 world = 0; world < impl.mesh.n_worlds; ++world)
    if (worlds[world])
      impl.anchors[world] = anchors_of(of_world(rows, impl.friction.first, world),
                                       std::span(strains).subspan(3 * impl.friction.first[world]));
}

const std::vector<std::vector<FrictionAnchor>>& ContactSet::anchors() const { return impl_->anchors; }
void ContactSet::restore_anchors(const std::vector<std::vector<FrictionAnchor>>& anchors) { impl_->anchors = anchors; }

void ContactSet::clear_friction() {
  impl_->friction.first.assign(impl_->mesh.n_worlds + 1, 0);
  impl_->friction.rows.resize(0);
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
  const std::vector<Friction> friction = impl.friction.rows.read();
  std::map<PairKey, Vec3> sliding = impl.friction_forces(friction, x, x0, h);
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
