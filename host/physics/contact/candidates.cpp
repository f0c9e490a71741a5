#include "host/physics/contact/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace pvg {
namespace {

// of half the margin; the rest covers rounding and what a straight way between two rotations shrinks
constexpr double USABLE = 0.98;
constexpr double MOST_ROTATION = 0.05;  // in one motion [rad]: shrinks by at most 1 - cos(0.025) = 3e-4
// Parts of one body that lie close together at rest are candidates at any margin above a quarter of their gap, though
// mostly they never touch. Of a fine mesh these are so many that a smaller margin, with which the pairs are looked for
// more often, costs less: by measurement where there are more than a pair for every MANY primitives that look.
constexpr std::size_t MANY = 32;

std::map<u32, std::vector<u32>> surface_sites(const CollisionMesh& mesh) {
  std::map<u32, std::vector<u32>> of_body;
  for (const CollisionPoint& each : mesh.points) of_body[each.body].push_back(each.site);
  for (const CollisionEdge& each : mesh.edges)
    of_body[each.body].insert(of_body[each.body].end(), each.site, each.site + 2);
  for (const CollisionTriangle& each : mesh.triangles)
    of_body[each.body].insert(of_body[each.body].end(), each.site, each.site + 3);
  for (auto& [body, sites] : of_body) {
    std::sort(sites.begin(), sites.end());
    sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
  }
  return of_body;
}

WorldRows<Barrier> no_rows(Device& device, std::size_t n_worlds) {
  return {Buffer<Barrier>(device, 0, "candidates"), std::vector<u32>(n_worlds + 1, 0)};
}

}  // namespace

Candidates::Within Candidates::make_within(Device& device, const CollisionMesh& mesh,
                                           std::span<const ContactSettings> settings, std::span<const Vec3> x,
                                           PairsOf which) {
  std::vector<u32> first = {0}, all;
  for (const auto& [body, sites] : surface_sites(mesh)) {
    const PairsOf own = mesh.bodies[body].offset > 0 ? PairsOf::one_sheet : PairsOf::one_solid;
    if (!mesh.bodies[body].collides_with_itself || own != which) continue;
    all.insert(all.end(), sites.begin(), sites.end());
    first.push_back(u32(all.size()));
  }
  return {BroadPhase(device, mesh, settings, x, which),      no_rows(device, mesh.n_worlds),
          Buffer<u32>(device, first, "first_site"),          Buffer<u32>(device, all, "sites"),
          Buffer<double>(device, 3 * x.size(), "reference"), margin_};
}

Candidates::Candidates(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
                       std::span<const Vec3> x, double margin, double least_margin)
    : device_(&device),
      n_worlds_(mesh.n_worlds),
      margin_(margin),
      least_margin_(least_margin),
      solids_(make_within(device, mesh, settings, x, PairsOf::one_solid)),
      sheets_(make_within(device, mesh, settings, x, PairsOf::one_sheet)),
      between_bodies_(device, mesh, settings, x, PairsOf::two_bodies),
      program_(device, "contact/contact.cl"),
      serves_program_(device, "contact/serves.cl"),
      place_rows_(program_.kernel("place_rows")),
      lists_serve_(serves_program_.kernel("lists_serve")),
      between_(no_rows(device, n_worlds_)),
      rows_(no_rows(device, n_worlds_)),
      first_(device, n_worlds_ + 1, "first candidate of world"),
      place_(device, n_worlds_, "place of world"),
      first_of_world_(device, rows_.first, "first_candidate_of_world"),
      surface_sites_(device, 0, "surface"),
      reference_(device, 3 * x.size(), "reference"),
      serves_on_device_(device, N_LISTS, "serves"),
      serves_(N_LISTS, 0) {
  std::vector<u32> all;
  for (const auto& [body, sites] : surface_sites(mesh)) all.insert(all.end(), sites.begin(), sites.end());
  surface_sites_.resize(all.size());
  surface_sites_.write(all);
  serves_on_device_.zero();
}

bool Candidates::has_reference(List list) const {
  return list == BETWEEN ? has_reference_ : (list == SOLIDS ? solids_ : sheets_).has_reference;
}

void Candidates::start_check(const Buffer<double>& x0, const Buffer<double>& x1) {
  if (surface_sites_.size() == 0) return;  // nothing collides
  const auto allowed = [](double margin) { return USABLE * 0.5 * margin; };
  ++check_;
  // lists that were never made are not checked, nor those that stay empty
  const auto n_checked = [](const BroadPhase& broad_phase, bool& has_reference, std::size_t n) {
    if (!broad_phase.finds_nothing()) return has_reference ? u32(n) : 0;
    has_reference = true;
    return 0u;
  };
  const u32 n_solids = n_checked(solids_.broad_phase, solids_.has_reference, solids_.first_site.size() - 1),
            n_sheets = n_checked(sheets_.broad_phase, sheets_.has_reference, sheets_.first_site.size() - 1),
            n_surface = n_checked(between_bodies_, has_reference_, surface_sites_.size());
  const u32 n = u32(GROUP_SIZE) * (n_solids + n_sheets + u32((n_surface + GROUP_SIZE - 1) / GROUP_SIZE));
  if (n > 0)
    lists_serve_(n, n, n_solids, solids_.first_site, solids_.sites, solids_.reference, n_sheets, sheets_.first_site,
                 sheets_.sites, sheets_.reference, n_surface, surface_sites_, reference_, x0, x1,
                 allowed(solids_.margin), allowed(sheets_.margin), allowed(margin_), MOST_ROTATION, check_,
                 serves_on_device_);
  serves_on_device_.read_later(0, std::span(serves_));
}

void Candidates::find(const Buffer<double>& x0, const Buffer<double>& x1) {
  if (surface_sites_.size() == 0) return;
  start_check(x0, x1);
  device_->finish();
  renew(x0, x1);
}

void Candidates::search(List list, const Buffer<double>& x0, const Buffer<double>& x1) {
  if (list == BETWEEN) {
    between_bodies_.find(x0, x1, margin_, between_);
    reference_.copy_from(x1);
    has_reference_ = true;
    return;
  }
  Within& within = list == SOLIDS ? solids_ : sheets_;
  within.broad_phase.find(x0, x1, within.margin, within.pairs);
  while (within.pairs.n() > within.broad_phase.n_queries() / MANY && within.margin > least_margin_) {
    within.margin = std::max(least_margin_, 0.5 * within.margin);
    within.broad_phase.find(x0, x1, within.margin, within.pairs);
  }
  within.reference.copy_from(x1);
  within.has_reference = true;
}

Candidates::Lists Candidates::renew(const Buffer<double>& x0, const Buffer<double>& x1, const Lists& at_once) {
  Lists lacking = {};
  if (surface_sites_.size() == 0) return lacking;
  for (const List list : {SOLIDS, SHEETS, BETWEEN})
    if (at_once[list]) search(list, x0, x1);
  bool has_changed = false;
  for (const List list : {SOLIDS, SHEETS, BETWEEN}) {
    lacking[list] = !serves(list);
    if (lacking[list] && !at_once[list]) search(list, x0, x1);
    has_changed |= lacking[list] || at_once[list];
  }
  serves_.assign(N_LISTS, 0);  // for this motion they all do
  if (has_changed) merge();
  return lacking;
}

void Candidates::merge() {
  const std::array<const WorldRows<Barrier>*, 3> lists = {&solids_.pairs, &sheets_.pairs, &between_};
  std::array<std::vector<u32>, 3> places;  // [n_worlds] of each list
  u32 next = 0;
  for (std::size_t w = 0; w < n_worlds_; ++w) {
    rows_.first[w] = next;
    for (std::size_t i = 0; i < lists.size(); ++i) {
      places[i].push_back(next);
      next += lists[i]->first[w + 1] - lists[i]->first[w];
    }
  }
  rows_.first[n_worlds_] = next;
  first_of_world_.write(rows_.first);
  rows_.rows.resize(rows_.n());
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (lists[i]->n() == 0) continue;
    first_.write(lists[i]->first);
    place_.write(places[i]);
    place_rows_(lists[i]->n(), lists[i]->n(), lists[i]->rows, first_, place_, rows_.rows);
  }
}

}  // namespace pvg
