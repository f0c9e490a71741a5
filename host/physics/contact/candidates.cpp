#include "host/physics/contact/candidates.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace pvg {
namespace {

// of half the margin; the rest covers rounding and what a straight way between two rotations shrinks
constexpr double USABLE = 0.98;
constexpr double MOST_ROTATION = 0.05;  // in one motion [rad]: shrinks by at most 1 - cos(0.025) = 3e-4

Vec3 point(std::span<const double> x, u32 site) { return Eigen::Map<const Vec3>(&x[3 * std::size_t(site)]); }

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

struct Fit {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double deviation = 0;  // largest distance that is left [m]
};

// The rigid motion that brings `reference` closest to where the sites are (Kabsch 1976).
Fit fit_rigid_motion(std::span<const Vec3> reference, std::span<const u32> sites, std::span<const double> x) {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  for (std::size_t i = 0; i < sites.size(); ++i) from += reference[i], to += point(x, sites[i]);
  from /= double(sites.size());
  to /= double(sites.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < sites.size(); ++i)
    covariance += (reference[i] - from) * (point(x, sites[i]) - to).transpose();
  Fit fit;
  if (!covariance.allFinite()) {
    fit.deviation = INFINITY;
    return fit;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 sign = Vec3::Ones();
  if ((svd.matrixV() * svd.matrixU().transpose()).determinant() < 0) sign[2] = -1;
  fit.rotation = svd.matrixV() * sign.asDiagonal() * svd.matrixU().transpose();
  for (std::size_t i = 0; i < sites.size(); ++i)
    fit.deviation = std::max(fit.deviation, (point(x, sites[i]) - to - fit.rotation * (reference[i] - from)).norm());
  return fit;
}

WorldRows<Barrier> no_rows(Device& device, std::size_t n_worlds) {
  return {Buffer<Barrier>(device, 0, "candidates"), std::vector<u32>(n_worlds + 1, 0)};
}

}  // namespace

Candidates::Candidates(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
                       std::span<const Vec3> x, double margin)
    : n_worlds_(mesh.n_worlds),
      margin_(margin),
      solids_{BroadPhase(device, mesh, settings, x, PairsOf::one_solid), no_rows(device, n_worlds_), {}},
      sheets_{BroadPhase(device, mesh, settings, x, PairsOf::one_sheet), no_rows(device, n_worlds_), {}},
      between_bodies_(device, mesh, settings, x, PairsOf::two_bodies),
      program_(device, "contact/contact.cl"),
      place_rows_(program_.kernel("place_rows")),
      between_(no_rows(device, n_worlds_)),
      rows_(no_rows(device, n_worlds_)),
      first_(device, n_worlds_ + 1, "first candidate of world"),
      place_(device, n_worlds_, "place of world") {
  for (const auto& [body, sites] : surface_sites(mesh)) {
    surface_sites_.insert(surface_sites_.end(), sites.begin(), sites.end());
    if (mesh.bodies[body].collides_with_itself)
      (mesh.bodies[body].offset > 0 ? sheets_ : solids_).bodies.push_back({sites, {}});
  }
}

bool Candidates::serves_between(std::span<const double> x0, std::span<const double> x1) const {
  if (reference_.empty()) return false;
  const double allowed = USABLE * 0.5 * margin_;
  for (const std::span<const double>& x : {x0, x1})
    for (const u32 site : surface_sites_)
      if (!((point(x, site) - point(reference_, site)).norm() <= allowed)) return false;
  return true;
}

bool Candidates::Within::serves(std::span<const double> x0, std::span<const double> x1, double margin) const {
  const double allowed = USABLE * 0.5 * margin;
  for (const Deformable& body : bodies) {
    if (body.reference.empty()) return false;
    const Fit start = fit_rigid_motion(body.reference, body.sites, x0);
    if (!(start.deviation <= allowed)) return false;
    const Fit end = fit_rigid_motion(body.reference, body.sites, x1);
    if (!(end.deviation <= allowed)) return false;
    if (Eigen::AngleAxisd(start.rotation.transpose() * end.rotation).angle() > MOST_ROTATION) return false;
  }
  return true;
}

void Candidates::find(const Buffer<double>& x0, const Buffer<double>& x1) {
  if (surface_sites_.empty()) return;  // nothing collides
  const std::vector<double> start = x0.read(), end = x1.read();
  bool has_changed = false;
  for (Within* within : {&solids_, &sheets_}) {
    if (within->serves(start, end, margin_)) continue;
    within->broad_phase.find(x0, x1, margin_, within->pairs);
    for (Deformable& body : within->bodies) {
      body.reference.clear();
      for (const u32 site : body.sites) body.reference.push_back(point(end, site));
    }
    has_changed = true;
  }
  if (!serves_between(start, end)) {
    between_bodies_.find(x0, x1, margin_, between_);
    reference_ = end;
    has_changed = true;
  }
  if (has_changed) merge();
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
  rows_.rows.resize(rows_.n());
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (lists[i]->n() == 0) continue;
    first_.write(lists[i]->first);
    place_.write(places[i]);
    place_rows_(lists[i]->n(), lists[i]->n(), lists[i]->rows, first_, place_, rows_.rows);
  }
}

}  // namespace pvg
