#include "host/physics/contact/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace pvg {
namespace {

// of half the margin; the rest covers rounding and what a straight way between two rotations shrinks
constexpr double USABLE = 0.98;
constexpr double MOST_ROTATION = 0.05;  // in one motion [rad]: shrinks by at most 1 - cos(0.025) = 3e-4
// Parts of one body that lie close together at rest are candidates at any margin above a quarter of their gap, though
// mostly they never touch. Of a fine mesh these are so many that a smaller margin, with which the pairs are looked for
// more often, costs less: by measurement where there are more than a pair for every MANY primitives that look.
constexpr std::size_t MANY = 32;

double allowed(double margin) { return USABLE * 0.5 * margin; }

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

Margins margins_of(const Device& device, std::span<const ContactSettings> settings, double correction) {
  double nearest = INFINITY;  // of the activation distances
  for (const ContactSettings& s : settings) nearest = std::min(nearest, s.activation_distance);
  const bool is_apart = !device.info().runs_host_functions;
  const double usual = std::max((is_apart ? 2 : 0.5) * nearest, 4 * correction);
  return {usual, is_apart ? usual : 0.1 * nearest};
}

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
  return {BroadPhase(device, mesh, settings, x, which), no_rows(device, mesh.n_worlds),
          Buffer<u32>(device, first, "first_site"), Buffer<u32>(device, all, "sites"), margin_};
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
      serves_program_(device, "contact/lists_serve.cl"),
      merge_lists_(program_.kernel("merge_lists")),
      lists_serve_(serves_program_.kernel("lists_serve")),
      between_(no_rows(device, n_worlds_)),
      rows_(no_rows(device, n_worlds_)),
      found_(device, N_LISTS * (n_worlds_ + 1), "found"),
      first_of_world_(device, rows_.first, "first_candidate_of_world"),
      surface_sites_(device, 0, "surface"),
      serves_on_device_(device, N_LISTS, "serves"),
      serves_(N_LISTS, 0),
      read_found_(found_.size(), 0),
      foreseen_serves_(N_LISTS, 0) {
  std::vector<u32> all;
  for (const auto& [body, sites] : surface_sites(mesh)) all.insert(all.end(), sites.begin(), sites.end());
  surface_sites_.resize(all.size());
  surface_sites_.write(all);
  serves_on_device_.zero();
}

bool Candidates::has_reference(List list) const {
  return list == BETWEEN ? has_reference_ : (list == SOLIDS ? solids_ : sheets_).has_reference;
}

void Candidates::forget_reference(List list) {
  (list == BETWEEN ? has_reference_ : (list == SOLIDS ? solids_ : sheets_).has_reference) = false;
}

Candidates::Checked Candidates::begin_check() {
  ++check_;
  // lists that were never made are not checked, nor those that stay empty
  const auto n_checked = [](const BroadPhase& broad_phase, bool& has_reference, std::size_t n) {
    if (!broad_phase.finds_nothing()) return has_reference ? u32(n) : 0;
    has_reference = true;
    return 0u;
  };
  return {n_checked(solids_.broad_phase, solids_.has_reference, solids_.first_site.size() - 1),
          n_checked(sheets_.broad_phase, sheets_.has_reference, sheets_.first_site.size() - 1),
          n_checked(between_bodies_, has_reference_, surface_sites_.size())};
}

void Candidates::start_check(const Buffer<double>& x0, const Buffer<double>& x1) {
  is_check_deferred_ = false;
  if (surface_sites_.size() == 0) return;  // nothing collides
  const Checked checked = begin_check();
  const u32 n = u32(GROUP_SIZE) * checked.n_groups();
  if (n > 0)
    lists_serve_(n, n, checked.n_solids, solids_.first_site, solids_.sites, solids_.broad_phase.reference(),
                 checked.n_sheets, sheets_.first_site, sheets_.sites, sheets_.broad_phase.reference(),
                 checked.n_surface, surface_sites_, between_bodies_.reference(), x0, x1, allowed(solids_.margin),
                 allowed(sheets_.margin), allowed(margin_), MOST_ROTATION, check_, serves_on_device_);
  serves_on_device_.read_later(0, std::span(serves_));
}

void Candidates::start_certify(const Buffer<double>& x0, const Buffer<double>& x1, Buffer<double>& steps,
                               Buffer<double>& of_64) {
  is_check_deferred_ = false;
  if (surface_sites_.size() == 0) return;
  if (!check_and_certify_) {
    Program program(*device_, "contact/check_and_certify.cl");
    check_and_certify_.emplace(program.kernel("check_and_certify"));
  }
  const Checked checked = begin_check();
  const u32 group = u32(GROUP_SIZE), n_pairs = rows_.n();
  const u32 n = group * (checked.n_groups() + (n_pairs + group - 1) / group);
  (*check_and_certify_)(n, n, checked.n_groups(), checked.n_solids, solids_.first_site, solids_.sites,
                        solids_.broad_phase.reference(), checked.n_sheets, sheets_.first_site, sheets_.sites,
                        sheets_.broad_phase.reference(), checked.n_surface, surface_sites_, between_bodies_.reference(),
                        x0, x1, allowed(solids_.margin), allowed(sheets_.margin), allowed(margin_), MOST_ROTATION,
                        check_, serves_on_device_, n_pairs, rows_.rows, steps, of_64);
  serves_on_device_.read_later(0, std::span(serves_));
}

void Candidates::find(const Buffer<double>& x0, const Buffer<double>& x1) {
  if (surface_sites_.size() == 0) return;
  start_check(x0, x1);
  device_->finish();
  renew(x0, x1);
}

BroadPhase& Candidates::broad_phase(List list) {
  return list == BETWEEN ? between_bodies_ : (list == SOLIDS ? solids_ : sheets_).broad_phase;
}

WorldRows<Barrier>& Candidates::pairs(List list) {
  return list == BETWEEN ? between_ : (list == SOLIDS ? solids_ : sheets_).pairs;
}

u32 Candidates::n_found(List list) const { return read_found_[list * (n_worlds_ + 1) + n_worlds_]; }

void Candidates::search(List list, const Buffer<double>& x0, const Buffer<double>& x1) {
  if (list == BETWEEN) {
    between_bodies_.find(x0, x1, margin_, between_);
    has_reference_ = true;
  } else {
    Within& within = list == SOLIDS ? solids_ : sheets_;
    within.broad_phase.find(x0, x1, within.margin, within.pairs);
    while (within.pairs.n() > within.broad_phase.n_queries() / MANY && within.margin > least_margin_) {
      within.margin = std::max(least_margin_, 0.5 * within.margin);
      within.broad_phase.find(x0, x1, within.margin, within.pairs);
    }
    within.has_reference = true;
  }
  room_[list] = pairs(list).n();
}

Candidates::Lists Candidates::lacking() const {
  Lists lacking = {};
  for (const List list : {SOLIDS, SHEETS, BETWEEN}) lacking[list] = !has_reference(list) || serves_[list] == check_;
  return lacking;
}

void Candidates::start_renew(const Buffer<double>& x0, const Buffer<double>& x1, const Lists& which) {
  if (surface_sites_.size() == 0) return;
  for (const List list : {SOLIDS, SHEETS, BETWEEN}) {
    if (!which[list]) continue;
    if (!has_reference(list)) {  // how much room it needs is not known
      search(list, x0, x1);
      continue;
    }
    const u32 n = pairs(list).n();
    room_[list] = broad_phase(list).finds_nothing() ? 0 : n + n / 4 + u32(GROUP_SIZE);
    broad_phase(list).start_find(x0, x1, list == BETWEEN ? margin_ : (list == SOLIDS ? solids_ : sheets_).margin,
                                 room_[list], pairs(list).rows);
    is_late_[list] = true;
  }
  start_merge();
  found_.read_later(0, std::span(read_found_));
}

Candidates::Lists Candidates::renew(const Buffer<double>& x0, const Buffer<double>& x1) {
  if (surface_sites_.size() == 0) return {};
  const Lists lacked = lacking();
  bool searches = false;
  for (const List list : {SOLIDS, SHEETS, BETWEEN}) {
    if (is_late_[list]) take_late(list);
    if (serves(list)) {
      room_[list] = pairs(list).n();
      continue;
    }
    search(list, x0, x1);
    searches = true;
  }
  is_late_ = {};
  serves_.assign(N_LISTS, 0);  // for this motion they all do
  if (searches) start_merge();
  sum_worlds();
  return lacked;
}

void Candidates::take_late(List list) {
  const auto first = read_found_.begin() + std::ptrdiff_t(list * (n_worlds_ + 1));
  pairs(list).first.assign(first, first + std::ptrdiff_t(n_worlds_ + 1));
}

void Candidates::sum_worlds() {
  for (std::size_t w = 0; w <= n_worlds_; ++w)
    rows_.first[w] = solids_.pairs.first[w] + sheets_.pairs.first[w] + between_.first[w];
}

void Candidates::foresee() {
  std::swap(serves_, foreseen_serves_);  // where the device writes to
  foreseen_check_ = check_;
  foreseen_is_late_ = std::exchange(is_late_, {});
}

bool Candidates::take_foreseen() {
  if (surface_sites_.size() == 0) return true;
  bool served = true;
  for (const List list : {SOLIDS, SHEETS, BETWEEN}) {
    lacked_[list] = !has_reference(list) || foreseen_serves_[list] == foreseen_check_;
    if (!foreseen_is_late_[list]) {
      served = served && !lacked_[list];
      continue;
    }
    take_late(list);
    if (n_found(list) > room_[list]) {  // what had no room is lacking at any motion
      served = false;
      forget_reference(list);
    }
    room_[list] = pairs(list).n();
  }
  sum_worlds();
  return served;
}

void Candidates::start_merge() {
  const u32 n = room_[SOLIDS] + room_[SHEETS] + room_[BETWEEN];
  rows_.first.back() = n;
  rows_.rows.resize(n);
  const std::size_t n_items = std::max<std::size_t>(1, n);
  const auto offsets = [&](List list) -> const Buffer<u32>& { return broad_phase(list).offsets(); };
  const auto first_query = [&](List list) -> const Buffer<u32>& { return broad_phase(list).first_query_of_world(); };
  merge_lists_(n_items, n, u32(n_worlds_), room_[SOLIDS], offsets(SOLIDS), first_query(SOLIDS), solids_.pairs.rows,
               room_[SHEETS], offsets(SHEETS), first_query(SHEETS), sheets_.pairs.rows, room_[BETWEEN],
               offsets(BETWEEN), first_query(BETWEEN), between_.rows, found_, first_of_world_, rows_.rows);
}

}  // namespace pvg
