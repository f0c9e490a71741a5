#include "host/capture/planes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

namespace pvg {
namespace {

constexpr int TRIALS = 400;    // per plane
constexpr double CELL = 0.04;  // edge of the cubes whose facets share one normal: those of single facets are noisy [m]

struct Facet {
  Vec3 center, normal;
  double area;
  std::size_t cell = 0;  // of Facets::cells
  bool is_taken = false;
};

struct PlaneFit {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0;  // normal . x = offset
};

struct Facets {
  std::vector<Facet> all;
  std::vector<Facet> cells;  // what lies in each cube, as one
};

// A triangle in pieces whose edges are no longer than a cell: its longest edge is halved as often as it takes.
void add_pieces(const std::array<Vec3, 3>& triangle, std::vector<std::array<Vec3, 3>>& pieces) {
  std::vector<std::array<Vec3, 3>> open = {triangle};
  while (!open.empty()) {
    const std::array<Vec3, 3> t = open.back();
    open.pop_back();
    std::size_t longest = 0;
    const auto length = [&](std::size_t k) { return (t[(k + 1) % 3] - t[k]).norm(); };
    for (const std::size_t k : {1, 2})
      if (length(k) > length(longest)) longest = k;
    if (length(longest) <= CELL) {
      pieces.push_back(t);
      continue;
    }
    const Vec3 &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
    const Vec3 middle = 0.5 * (a + b);
    open.push_back({a, middle, c});
    open.push_back({middle, b, c});
  }
}

Facets facets_of(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles) {
  Facets out;
  std::map<std::array<int, 3>, std::size_t> place;
  std::vector<std::array<Vec3, 3>> pieces;
  for (const Triangle& t : triangles)
    add_pieces({points[t[0]].cast<double>(), points[t[1]].cast<double>(), points[t[2]].cast<double>()}, pieces);
  for (const auto& [a, b, c] : pieces) {
    const Vec3 n = (b - a).cross(c - a), center = (a + b + c) / 3;
    const double area = n.norm() / 2;
    if (!(area > 0)) continue;
    const std::array<int, 3> cube = {int(std::floor(center.x() / CELL)), int(std::floor(center.y() / CELL)),
                                     int(std::floor(center.z() / CELL))};
    const std::size_t at = place.try_emplace(cube, out.cells.size()).first->second;
    if (at == out.cells.size()) out.cells.push_back({Vec3::Zero(), Vec3::Zero(), 0});
    Facet& cell = out.cells[at];
    cell.center += area * center;
    cell.normal += n / 2;
    cell.area += area;
    out.all.push_back({center, n, area, at});
  }
  for (Facet& cell : out.cells) {
    cell.center /= cell.area;
    cell.normal.normalize();
  }
  for (Facet& facet : out.all) facet.normal = out.cells[facet.cell].normal;
  return out;
}

bool is_on(const Facet& f, const PlaneFit& plane, const PlaneSettings& s) {
  return std::abs(plane.normal.dot(f.center) - plane.offset) < s.distance &&
         plane.normal.dot(f.normal) > std::cos(s.angle);
}

struct Moments {
  double area = 0;
  Vec3 center = Vec3::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();  // mean square about the centre [m^2]
};

Moments moments_of(const std::vector<Facet>& facets, const std::vector<std::size_t>& chosen) {
  Moments m;
  for (const std::size_t i : chosen) {
    m.area += facets[i].area;
    m.center += facets[i].area * facets[i].center;
  }
  m.center /= m.area;
  for (const std::size_t i : chosen) {
    const Vec3 d = facets[i].center - m.center;
    m.spread += facets[i].area / m.area * d * d.transpose();
  }
  return m;
}

// the largest group of facets of one plane that hang together on a grid of cells, so that a table and a shelf at the
// same height are two
std::vector<std::size_t> largest_patch(const std::vector<Facet>& facets, const std::vector<std::size_t>& chosen,
                                       const Vec3& normal) {
  if (chosen.empty()) return {};
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<std::array<int, 2>> cell;
  std::array<int, 2> low = {1 << 30, 1 << 30}, high = {-(1 << 30), -(1 << 30)};
  for (const std::size_t i : chosen) {
    cell.push_back({int(std::floor(u.dot(facets[i].center) / CELL)), int(std::floor(v.dot(facets[i].center) / CELL))});
    for (int k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], cell.back()[k]);
      high[k] = std::max(high[k], cell.back()[k]);
    }
  }
  const std::size_t nx = std::size_t(high[0] - low[0] + 1), ny = std::size_t(high[1] - low[1] + 1);
  std::vector<double> area(nx * ny, 0.0);
  const auto index = [&](const std::array<int, 2>& c) {
    return std::size_t(c[1] - low[1]) * nx + std::size_t(c[0] - low[0]);
  };
  for (std::size_t k = 0; k < chosen.size(); ++k) area[index(cell[k])] += facets[chosen[k]].area;
  std::vector<int> label(nx * ny, -1);
  std::vector<double> label_area;
  for (std::size_t start = 0; start < area.size(); ++start) {
    if (label[start] >= 0 || area[start] < 0.2 * CELL * CELL) continue;
    const int now = int(label_area.size());
    label_area.push_back(0);
    std::vector<std::size_t> open = {start};
    label[start] = now;
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      label_area.back() += area[at];
      const int x = int(at % nx), y = int(at / nx);
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int X = x + dx, Y = y + dy;
          if (X < 0 || Y < 0 || X >= int(nx) || Y >= int(ny)) continue;
          const std::size_t next = std::size_t(Y) * nx + std::size_t(X);
          if (label[next] >= 0 || area[next] < 0.2 * CELL * CELL) continue;
          label[next] = now;
          open.push_back(next);
        }
    }
  }
  if (label_area.empty()) return {};
  const int best = int(std::max_element(label_area.begin(), label_area.end()) - label_area.begin());
  std::vector<std::size_t> patch;
  for (std::size_t k = 0; k < chosen.size(); ++k)
    if (label[index(cell[k])] == best) patch.push_back(chosen[k]);
  return patch;
}

// x and y of the pose along the sides of the smallest of 90 rectangles that hold 98 % of the area in each direction
void fit_rectangle(CapturedPlane& plane, const std::vector<Facet>& facets, const std::vector<std::size_t>& chosen,
                   const Vec3& normal, const Vec3& center) {
  constexpr int TURNS = 90;
  constexpr double LEFT_OUT = 0.01;  // at each side
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  double best = INFINITY;
  for (int turn = 0; turn < TURNS; ++turn) {
    const double angle = turn * M_PI / 2 / TURNS;
    const Vec3 x = std::cos(angle) * u + std::sin(angle) * v, y = normal.cross(x);
    double low[2], high[2];
    for (int k = 0; k < 2; ++k) {
      std::vector<double> along;
      for (const std::size_t i : chosen) along.push_back((k ? y : x).dot(facets[i].center - center));
      const auto at = [&](double share) {
        const auto it = along.begin() + std::ptrdiff_t(share * double(along.size() - 1));
        std::nth_element(along.begin(), it, along.end());
        return *it;
      };
      low[k] = at(LEFT_OUT);
      high[k] = at(1 - LEFT_OUT);
    }
    const double size = (high[0] - low[0]) * (high[1] - low[1]);
    if (!(size < best)) continue;
    best = size;
    plane.width = high[0] - low[0];
    plane.height = high[1] - low[1];
    plane.pose.linear().col(0) = x;
    plane.pose.linear().col(1) = y;
    plane.pose.linear().col(2) = normal;
    plane.pose.translation() = center + 0.5 * (low[0] + high[0]) * x + 0.5 * (low[1] + high[1]) * y;
  }
  if (plane.width >= plane.height) return;
  std::swap(plane.width, plane.height);
  const Vec3 x = plane.pose.linear().col(0);
  plane.pose.linear().col(0) = plane.pose.linear().col(1);
  plane.pose.linear().col(1) = -x;
}

std::vector<std::size_t> facets_on(const std::vector<Facet>& facets, const PlaneFit& plane, const PlaneSettings& s) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < facets.size(); ++i)
    if (!facets[i].is_taken && is_on(facets[i], plane, s)) chosen.push_back(i);
  return chosen;
}

PlaneFit fit_to(const Moments& m, const Vec3& side) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m.spread);
  PlaneFit plane;
  plane.normal = solver.eigenvectors().col(0);
  if (plane.normal.dot(side) < 0) plane.normal = -plane.normal;
  plane.offset = plane.normal.dot(m.center);
  return plane;
}

}  // namespace

std::vector<CapturedPlane> find_planes(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles,
                                       const PlaneSettings& settings, double correlation_length) {
  auto [facets, cells] = facets_of(points, triangles);
  std::mt19937_64 random(settings.seed);
  std::vector<CapturedPlane> planes;
  for (int attempt = 0; attempt < 3 * settings.most && int(planes.size()) < settings.most; ++attempt) {
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (!cells[i].is_taken) left.push_back(i);
    if (left.empty()) break;
    PlaneFit best;
    double best_area = 0;
    for (int trial = 0; trial < TRIALS; ++trial) {
      const Facet& seed = cells[left[random() % left.size()]];
      const PlaneFit plane{seed.normal, seed.normal.dot(seed.center)};
      double area = 0;
      for (const std::size_t i : left)
        if (is_on(cells[i], plane, settings)) area += cells[i].area;
      if (area > best_area) {
        best_area = area;
        best = plane;
      }
    }
    if (best_area == 0) break;
    std::vector<std::size_t> chosen;
    for (int round = 0; round < 4; ++round) {
      chosen = largest_patch(facets, facets_on(facets, best, settings), best.normal);
      if (chosen.size() < 3) break;
      best = fit_to(moments_of(facets, chosen), best.normal);
    }
    if (chosen.size() < 3) continue;
    const Moments m = moments_of(facets, chosen);
    for (const std::size_t i : chosen) facets[i].is_taken = cells[facets[i].cell].is_taken = true;
    if (m.area < settings.least_area) continue;
    CapturedPlane plane;
    plane.area = m.area;
    plane.roughness = std::sqrt(std::max(0.0, best.normal.dot(m.spread * best.normal)));
    fit_rectangle(plane, facets, chosen, best.normal, m.center);
    const double independent = std::max(3.0, m.area / (correlation_length * correlation_length));
    plane.height_sigma = plane.roughness / std::sqrt(independent);
    // slope of a straight line through `independent` points spread evenly over the shorter side
    plane.tilt_sigma = plane.height_sigma * std::sqrt(12.0) / std::max(1e-3, plane.height);
    planes.push_back(plane);
  }
  std::sort(planes.begin(), planes.end(), [](const auto& a, const auto& b) { return a.area > b.area; });
  return planes;
}

}  // namespace pvg
