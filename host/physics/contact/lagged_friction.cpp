#include "host/physics/contact/lagged_friction.hpp"

#include <algorithm>
#include <utility>

#include "host/physics/contact/slip_effects.hpp"

namespace pvg {
namespace {

constexpr std::size_t WORTH_A_LAUNCH = 1 << 16;  // bytes: 7 us at 10 GB/s

template <class Row>
std::span<Row> of_world(std::vector<Row>& rows, const std::vector<u32>& first, u32 world) {
  return std::span(rows).subspan(first[world], first[world + 1] - first[world]);
}

std::vector<u32> sites_of(std::span<const Friction> rows) {
  std::vector<u32> sites;
  for (const Friction& row : rows) sites.insert(sites.end(), row.site, row.site + 4);
  return sites;
}

}  // namespace

LaggedFriction::LaggedFriction(Device& device, const CollisionMesh& mesh)
    : device_(&device),
      effects_(mesh.effects),
      n_worlds_(mesh.n_worlds),
      program_(device, "contact/contact.cl"),
      friction_program_(device, "energies/contact/friction.cl"),
      lag_friction_(program_.kernel("lag_friction")),
      anchor_friction_(program_.kernel("anchor_friction")),
      friction_force_(friction_program_.kernel("friction_force")),
      friction_strain_(friction_program_.kernel("friction_strain")),
      rows_{Buffer<Friction>(device, 0, "friction"), std::vector<u32>(n_worlds_ + 1, 0)},
      lagged_(device, 0, "lagged friction"),
      sites_on_device_(device, 0, "friction_sites"),
      first_(device, n_worlds_ + 1, "first_friction_of_world"),
      anchors_on_device_(device, 0, "friction anchors"),
      forces_(device, 0, "friction_forces"),
      strains_(device, 0, "friction_strains"),
      anchors_(n_worlds_) {}

void LaggedFriction::start(const WorldRows<Barrier>& contacts, const Buffer<u32>& first_contact,
                           const Buffer<CollisionWorld>& worlds, const Buffer<double>& x, std::size_t usual) {
  const u32 n = u32(contacts.rows.size());
  lagged_.resize(n);
  lag_friction_(n, n, n_worlds_, first_contact, contacts.rows, worlds, x, lagged_);
  read_lagged_.resize(std::min<std::size_t>(n, usual));
  lagged_.read_later(0, std::span(read_lagged_));
}

void LaggedFriction::take(const std::vector<u32>& contact_first, double h, const Buffer<double>& x0,
                          const Buffer<double>& x1) {
  rows_.first = contact_first;
  const std::size_t n = rows_.n(), n_read = read_lagged_.size();
  on_host_ = read_lagged_;
  on_host_.resize(n);
  if (n > n_read) lagged_.read(n_read, std::span(on_host_).subspan(n_read));
  for (u32 world = 0; world < n_worlds_; ++world)
    attach_anchors(anchors_[world], h, of_world(on_host_, rows_.first, world));
  const bool slip_changes = n > 0 && std::any_of(effects_.begin(), effects_.end(), changes_friction);
  if (slip_changes) apply_slip_effects(effects_, x0.read(), x1.read(), h, on_host_);
  sites_ = sites_of(on_host_);
  give_to_device(!slip_changes);
}

// On a device apart from the host most of a row is there already, but for the anchor: is_as_lagged. Many are not sent
// again; of a few the bytes take less than the launch that puts them together.
void LaggedFriction::give_to_device(bool is_as_lagged) {
  const u32 n = rows_.n();
  rows_.rows.resize(n);
  if (device_->info().runs_host_functions) return rows_.rows.write(on_host_);
  sites_on_device_.resize(sites_.size());
  if (is_as_lagged && n * sizeof(Friction) > WORTH_A_LAUNCH) {
    std::vector<double> anchors;
    for (const Friction& row : on_host_) anchors.insert(anchors.end(), row.anchor, row.anchor + 3);
    anchors_on_device_.resize(anchors.size());
    anchors_on_device_.write(anchors);
    anchor_friction_(n, n, lagged_, anchors_on_device_, rows_.rows, sites_on_device_);
  } else {
    rows_.rows.write(on_host_);
    if (sites_ != written_sites_) sites_on_device_.write(sites_);
  }
  written_sites_ = sites_;
  if (written_first_ == rows_.first) return;
  written_first_ = rows_.first;
  first_.write(written_first_);
}

void LaggedFriction::clear() {
  rows_.first.assign(n_worlds_ + 1, 0);
  on_host_.clear();
  sites_.clear();
  give_to_device(false);
}

void LaggedFriction::start_anchors(const Buffer<double>& x, const Buffer<double>& x0, double h) {
  const u32 n = rows_.n();
  strains_.resize(3 * n);
  friction_strain_(n, n, rows_.rows, x, x0, h, strains_);
  read_strains_.resize(3 * n);
  strains_.read_later(0, std::span(read_strains_));
}

void LaggedFriction::take_anchors(std::span<const char> worlds) {
  for (u32 world = 0; world < n_worlds_; ++world)
    if (worlds[world])
      anchors_[world] =
          anchors_of(of_world(on_host_, rows_.first, world), std::span(read_strains_).subspan(3 * rows_.first[world]));
}

std::map<PairKey, Vec3> LaggedFriction::forces(const Buffer<double>& x, const Buffer<double>& x0, double h) {
  const std::size_t n = on_host_.size();
  forces_.resize(3 * n);
  friction_force_(n, u32(n), rows_.rows, x, x0, h, forces_);
  const std::vector<double> values = forces_.read();
  std::map<PairKey, Vec3> found;
  for (std::size_t i = 0; i < n; ++i) found[pair_key(on_host_[i])] = Eigen::Map<const Vec3>(&values[3 * i]);
  return found;
}

}  // namespace pvg
