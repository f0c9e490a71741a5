// A ray o + t d touches a body where its deepest point lies on the surface:
//
//   min_t s(rho(t), z(t)) = 0,   rho(t) = |(o + t d)_xy - a|,   z(t) = (o + t d)_z,
//
// with s the signed distance in the half plane of radius and height to the meridian: the polygon of (0, 0), (r_0, 0),
// (r_1, h / n), ..., (r_n, h), (0, h). Unknowns are the axis a, the height h and the radii r_k. By the theorem of the
// envelope the slope of the minimum is that of s at the deepest point. Levenberg and Marquardt's method minimises the
// residuals in pixels, f s / t with the focal length f, with Huber's loss, and the radii's second differences, which
// decide where no ray touches, as in a hollow.
#include "host/capture/objects/vessel.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/base/statistics.hpp"

namespace pvg {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr std::size_t FEWEST_VIEWS = 3;
const std::string TOO_FEW = "a vessel takes masks of three photos or more, from different sides";
constexpr int RINGS = 33;
constexpr int SAMPLES = 32;        // along a ray, for the deepest point
constexpr int REFINEMENTS = 14;    // of the golden section between samples
constexpr double HUBER = 1.5;      // beyond, a residual counts linearly [pixels]
constexpr double STIFFNESS = 0.2;  // weight of a second difference, in pixels of the typical ray
constexpr int ITERATIONS = 60;
constexpr double CONVERGED = 1e-6;      // relative fall of the cost
constexpr std::size_t MOST_RAYS = 250;  // of a photo
constexpr double LARGEST_RESIDUAL = 2;  // [pixels]; beyond, it is no turned thing that stands on z = 0
constexpr double LARGEST_RATIO = 4;     // of one photo's residual to the median one, or to
constexpr double LEAST_MEDIAN = 0.5;    // the error of pixels [pixels]

// a place of the meridian: the nearest point of the polygon and the signed distance to it
struct Nearest {
  double distance = 0;         // negative inside
  Vec2 normal = Vec2::Zero();  // of the surface there, outward
  int ring = 0;      // the point lies between rings `ring` and `ring + 1` (of rings -1 and n the axis's points)
  double share = 0;  // of ring + 1
};

// vertex of the meridian: ring -1 and RINGS are on the axis
Vec2 vertex(const Vessel& v, int ring) {
  if (ring < 0) return {0, 0};
  if (ring >= RINGS) return {0, v.height};
  return {v.radii[std::size_t(ring)], v.height * ring / (RINGS - 1)};
}

bool is_inside(const Vessel& v, const Vec2& p) {
  if (p.y() < 0 || p.y() > v.height) return false;
  const double u = std::clamp(p.y() / v.height, 0.0, 1.0) * (RINGS - 1);
  const int ring = std::min(int(u), RINGS - 2);
  const double radius =
      v.radii[std::size_t(ring)] + (u - ring) * (v.radii[std::size_t(ring) + 1] - v.radii[std::size_t(ring)]);
  return p.x() < radius;
}

Nearest nearest_on_meridian(const Vessel& v, const Vec2& p) {
  Nearest best;
  double least = INFINITY;
  Vec2 to = Vec2::Zero(), along = Vec2::UnitX();
  for (int ring = -1; ring < RINGS; ++ring) {
    const Vec2 a = vertex(v, ring), b = vertex(v, ring + 1), ab = b - a;
    const double share = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-30), 0.0, 1.0);
    const Vec2 off = p - a - share * ab;
    if (off.squaredNorm() >= least) continue;
    least = off.squaredNorm();
    best.ring = ring;
    best.share = share;
    to = off;
    along = ab;
  }
  const double sign = is_inside(v, p) ? -1 : 1;
  best.distance = sign * std::sqrt(least);
  // on the surface itself the direction to the point says nothing
  best.normal = least > 1e-24 ? Vec2(sign * to.normalized()) : Vec2(along.y(), -along.x()).normalized();
  return best;
}

Vec2 meridian_point(const Vessel& v, const TouchingRay& ray, double t) {
  const Vec3 p = ray.origin + t * ray.direction;
  return {(p.head<2>() - v.axis).norm(), p.z()};
}

// where the ray is deepest inside the vessel, or nearest to it
double deepest(const Vessel& v, const TouchingRay& ray) {
  const Vec3 middle(v.axis.x(), v.axis.y(), 0.5 * v.height);
  const double center = (middle - ray.origin).dot(ray.direction);
  const double reach = 1.2 * std::hypot(*std::max_element(v.radii.begin(), v.radii.end()), v.height) +
                       (middle - ray.origin).norm() * 1e-3;
  const auto depth = [&](double t) { return nearest_on_meridian(v, meridian_point(v, ray, t)).distance; };
  const double step = 2 * reach / SAMPLES;
  double best = center, least = INFINITY;
  for (int k = 0; k <= SAMPLES; ++k)
    if (const double t = center - reach + k * step, d = depth(t); d < least) {
      least = d;
      best = t;
    }
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  double low = best - step, high = best + step;
  double a = high - golden * (high - low), b = low + golden * (high - low), at_a = depth(a), at_b = depth(b);
  for (int k = 0; k < REFINEMENTS; ++k) {
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - golden * (high - low);
      at_a = depth(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + golden * (high - low);
      at_b = depth(b);
    }
  }
  return 0.5 * (low + high);
}

constexpr int UNKNOWNS = 3 + RINGS;  // axis, height, radii
using Slope = Eigen::Matrix<double, UNKNOWNS, 1>;

// the residual of a ray [pixels] and its slope
double residual_of(const Vessel& v, const TouchingRay& ray, Slope* slope) {
  const double t = deepest(v, ray);
  const Vec2 p = meridian_point(v, ray, t);
  const Nearest at = nearest_on_meridian(v, p);
  const double scale = ray.pixels / std::max(t, 1e-6);
  if (slope) {
    slope->setZero();
    const Vec3 q = ray.origin + t * ray.direction;
    if (p.x() > 0) slope->head<2>() = -at.normal.x() * (q.head<2>() - v.axis) / p.x();
    // a vertex that moves along the normal brings the surface nearer
    for (const auto& [ring, share] : {std::pair{at.ring, 1 - at.share}, std::pair{at.ring + 1, at.share}}) {
      if (ring >= 0 && ring < RINGS) (*slope)[3 + ring] -= share * at.normal.x();
      (*slope)[2] -= share * at.normal.y() * vertex(v, ring).y() / v.height;
    }
    *slope *= scale;
  }
  return scale * at.distance;
}

double huber(double r) { return std::abs(r) <= HUBER ? r * r : HUBER * (2 * std::abs(r) - HUBER); }

// pixels per metre where the vessel stands, of the typical ray
double typical_scale(const Vessel& v, std::span<const TouchingRay> rays) {
  const Vec3 middle(v.axis.x(), v.axis.y(), 0.5 * v.height);
  std::vector<double> scales;
  for (const TouchingRay& ray : rays) scales.push_back(ray.pixels / (ray.origin - middle).norm());
  return upper_median(std::move(scales));
}

Slope second_difference(const Vessel& v, int ring, double weight, double& value) {
  Slope slope = Slope::Zero();
  const auto r = [&](int k) { return v.radii[std::size_t(k)]; };
  value = weight * (r(ring - 1) - 2 * r(ring) + r(ring + 1));
  slope[2 + ring] = slope[4 + ring] = weight;
  slope[3 + ring] = -2 * weight;
  return slope;
}

double cost_of(const Vessel& v, std::span<const TouchingRay> rays, double weight) {
  double cost = 0, value = 0;
  for (const TouchingRay& ray : rays) cost += huber(residual_of(v, ray, nullptr));
  for (int ring = 1; ring + 1 < RINGS; ++ring) {
    second_difference(v, ring, weight, value);
    cost += value * value;
  }
  return cost;
}

// the vertical axis that is nearest to all rays, seen from above
Vec2 nearest_axis(std::span<const TouchingRay> rays) {
  Eigen::Matrix2d A = 1e-9 * Eigen::Matrix2d::Identity();
  Vec2 b = Vec2::Zero();
  for (const TouchingRay& ray : rays) {
    const Vec2 n(-ray.direction.y(), ray.direction.x());
    A += n * n.transpose();
    b += n * n.dot(ray.origin.head<2>());
  }
  return A.ldlt().solve(b);
}

// a cylinder about the axis that is nearest to all rays
Vessel first_guess(std::span<const TouchingRay> rays) {
  Vessel v;
  v.axis = nearest_axis(rays);
  std::vector<double> heights, radii;  // where each ray passes the axis
  for (const TouchingRay& ray : rays) {
    const Vec2 u = ray.direction.head<2>();
    const double t = u.squaredNorm() > 1e-6 ? (v.axis - ray.origin.head<2>()).dot(u) / u.squaredNorm() : 0;
    if (t <= 0) continue;
    heights.push_back(ray.origin.z() + t * ray.direction.z());
    radii.push_back((ray.origin.head<2>() + t * u - v.axis).norm());
  }
  if (heights.empty()) throw UsageError("the photos look straight down; take some from the side");
  std::sort(heights.begin(), heights.end());
  std::sort(radii.begin(), radii.end());
  v.height = heights[heights.size() * 9 / 10];
  if (!(v.height > 0)) throw UsageError("the thing in the masks lies below z = 0, on which it should stand");
  v.radii.assign(RINGS, radii[radii.size() * 3 / 4]);
  return v;
}

Vessel moved(const Vessel& v, const Slope& step) {
  Vessel next = v;
  next.axis += step.head<2>();
  next.height = std::max(0.2 * v.height, v.height + step[2]);
  for (int k = 0; k < RINGS; ++k) {
    double& radius = next.radii[std::size_t(k)];
    radius = std::max(0.2 * radius, radius + step[3 + k]);
  }
  return next;
}

void judge_residuals(Vessel& v, std::span<const TouchingRay> rays, std::size_t n_views) {
  std::vector<double> sums(n_views, 0), counts(n_views, 0);
  double sum = 0;
  for (const TouchingRay& ray : rays) {
    const double r = residual_of(v, ray, nullptr);
    sum += r * r;
    sums[ray.view] += r * r;
    counts[ray.view] += 1;
  }
  v.residual = std::sqrt(sum / double(rays.size()));
  for (std::size_t i = 0; i < n_views; ++i)
    v.residual_of_view.push_back(counts[i] > 0 ? std::sqrt(sums[i] / counts[i]) : 0);
}

}  // namespace

Profile Vessel::outside() const {
  Profile profile = {{0, 0}};
  for (std::size_t k = 0; k < radii.size(); ++k)
    profile.emplace_back(radii[k], height * double(k) / double(radii.size() - 1));
  return profile;
}

Vessel fit_vessel(std::span<const TouchingRay> rays, std::size_t n_views) {
  std::vector<bool> is_used(n_views);
  for (const TouchingRay& ray : rays) is_used[ray.view] = true;
  if (std::size_t(std::count(is_used.begin(), is_used.end(), true)) < FEWEST_VIEWS) throw UsageError(TOO_FEW);
  Vessel v = first_guess(rays);
  const double weight = STIFFNESS * typical_scale(v, rays) * std::sqrt(double(rays.size()) / RINGS);
  double cost = cost_of(v, rays, weight), damping = 1e-3;
  for (int iteration = 0; iteration < ITERATIONS; ++iteration) {
    Eigen::Matrix<double, UNKNOWNS, UNKNOWNS> A = Eigen::Matrix<double, UNKNOWNS, UNKNOWNS>::Zero();
    Slope g = Slope::Zero(), slope;
    for (const TouchingRay& ray : rays) {
      const double r = residual_of(v, ray, &slope), share = std::min(1.0, HUBER / std::max(std::abs(r), 1e-12));
      A.selfadjointView<Eigen::Lower>().rankUpdate(slope, share);
      g += share * r * slope;
    }
    for (int ring = 1; ring + 1 < RINGS; ++ring) {
      double value = 0;
      slope = second_difference(v, ring, weight, value);
      A.selfadjointView<Eigen::Lower>().rankUpdate(slope);
      g += value * slope;
    }
    bool is_lower = false;
    double fall = 0;
    for (int attempt = 0; attempt < 10 && !is_lower; ++attempt) {
      Eigen::Matrix<double, UNKNOWNS, UNKNOWNS> damped = A;
      damped.diagonal() += damping * A.diagonal() + 1e-12 * A.diagonal().maxCoeff() * Slope::Ones();
      const Vessel next = moved(v, -damped.selfadjointView<Eigen::Lower>().ldlt().solve(g));
      const double lower = cost_of(next, rays, weight);
      is_lower = lower < cost;
      damping = is_lower ? std::max(1e-9, damping / 5) : damping * 5;
      if (!is_lower) continue;
      fall = (cost - lower) / cost;
      v = next;
      cost = lower;
    }
    if (!is_lower || fall < CONVERGED) break;
  }
  judge_residuals(v, rays, n_views);
  return v;
}

void check_residuals(const Vessel& vessel, std::span<const MaskedView> views) {
  const double median = upper_median(vessel.residual_of_view);
  if (median > LARGEST_RESIDUAL)
    throw UsageError(fmt::format(
        "no turned thing that stands upright on z = 0 has these masks (its outlines are {:.1f} pixels off); "
        "are the poses those of the masks, and is z = 0 the table?",
        median));
  for (std::size_t i = 0; i < views.size(); ++i)
    if (vessel.residual_of_view[i] > LARGEST_RATIO * std::max(median, LEAST_MEDIAN))
      throw UsageError(fmt::format(
          "the outline of {} is {:.1f} pixels off, of the others {:.1f}; mend its mask or its pose, or leave it out",
          views[i].mask.filename().string(), vessel.residual_of_view[i], median));
}

std::vector<MaskedView> read_vessel_views(const std::filesystem::path& folder) {
  std::vector<MaskedView> views = read_masked_views(folder);
  if (views.size() < FEWEST_VIEWS) throw UsageError(folder.string() + ": " + TOO_FEW);
  return views;
}

Vessel vessel_of_masks(Device& device, std::vector<MaskedView> views, double scale) {
  for (MaskedView& view : views) view.camera.pose.translation() *= scale;
  const std::vector<TouchingRay> rays = touching_rays(device, views, MOST_RAYS);
  try {
    const Vessel vessel = fit_vessel(rays, views.size());
    check_residuals(vessel, views);
    return vessel;
  } catch (const UsageError& error) {
    throw UsageError(views.front().mask.parent_path().string() + ": " + error.what());
  }
}

}  // namespace pvg
