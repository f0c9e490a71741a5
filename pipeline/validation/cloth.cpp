// Cloth against the heavy elastica and the drape test of Cusick.
#include <algorithm>
#include <cmath>

#include "pipeline/validation/cases.hpp"

namespace pvg {
namespace {

// Runs until no point of the cloth moves further than `at_rest` in a step [m], or to the scene's end.
struct Rest {
  std::vector<Vec3> x;
  double largest_move = 0;  // in the last step [m]
};

Rest cloth_at_rest(const Validation& v, const SceneRun& run, double at_rest) {
  Rest rest;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    const std::vector<Vec3>& x = state.cloth[0];
    rest.largest_move = rest.x.empty() ? at_rest : 0;
    for (std::size_t i = 0; i < rest.x.size(); ++i)
      rest.largest_move = std::max(rest.largest_move, (x[i] - rest.x[i]).norm());
    rest.x = x;
    return rest.largest_move >= at_rest;
  });
  return rest;
}

// ---- heavy cantilever -------------------------------------------------------------------------------------------

constexpr double STRIP_LENGTH = 0.1, STRIP_RIGIDITY = 1e-3;  // from the clamp to the tip [m], B [N m]

// Inner points moved in the plane by up to `share` of a cell, the same on every run; the first two columns, which are
// held, and the edges stay.
void make_irregular(TriangleMesh& mesh, double share) {
  double low = 0, high = 0;
  for (const Vec3& x : mesh.points) low = std::min(low, x.x()), high = std::max(high, x.y());
  const double cell = (mesh.points[1] - mesh.points[0]).norm();
  std::uint32_t state = 1;
  const auto uniform = [&] {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) / double(1 << 23) - 1;
  };
  for (Vec3& x : mesh.points) {
    const bool is_inner = x.x() > low + 1.5 * cell && x.x() < -low - 0.5 * cell && std::abs(x.y()) < high - 0.5 * cell;
    if (is_inner) x += share * cell * Vec3(uniform(), uniform(), 0);
  }
}

// drop of the strip's end over its length, where gamma = rho g L^3 / B
double strip_drop(const Validation& v, double gamma, double irregularity) {
  SceneRun run = v.load("heavy_cantilever_cloth");
  Cloth& strip = run.scene.cloths[0];
  strip.material.area_density = gamma * STRIP_RIGIDITY / (9.81 * std::pow(STRIP_LENGTH, 3));
  make_irregular(strip.mesh, irregularity);
  const std::vector<Vec3> x = cloth_at_rest(v, run, 1e-7).x;
  double end = 0, sum = 0;
  for (const Vec3& point : strip.mesh.points) end = std::max(end, point.x());
  int n = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (strip.mesh.points[i].x() > end - 1e-7) sum += x[i].z(), ++n;
  return -sum / n / STRIP_LENGTH;
}

// ---- drape ------------------------------------------------------------------------------------------------------

// Area that triangles cover from above, and a disc around the origin of this radius with them [m^2].
double shadow_area(const std::vector<Vec3>& x, const std::vector<Triangle>& triangles, double disc_radius) {
  constexpr int N = 800;
  constexpr double CELL = 0.4 / N;  // [m]
  const auto center = [](int i) { return (i + 0.5 - N / 2) * CELL; };
  const auto cell = [](double value) { return std::clamp(int(std::floor(value / CELL)) + N / 2, 0, N - 1); };
  std::vector<char> is_dark(N * N, false);
  for (const Triangle& t : triangles) {
    const Vec3 a = x[t[0]], b = x[t[1]], c = x[t[2]];
    const auto side = [](const Vec3& from, const Vec3& to, double px, double py) {
      return (to.x() - from.x()) * (py - from.y()) - (to.y() - from.y()) * (px - from.x());
    };
    for (int j = cell(std::min({a.y(), b.y(), c.y()})); j <= cell(std::max({a.y(), b.y(), c.y()})); ++j)
      for (int i = cell(std::min({a.x(), b.x(), c.x()})); i <= cell(std::max({a.x(), b.x(), c.x()})); ++i) {
        const double ab = side(a, b, center(i), center(j)), bc = side(b, c, center(i), center(j)),
                     ca = side(c, a, center(i), center(j));
        if ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0)) is_dark[i + N * j] = true;
      }
  }
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i)
      if (std::hypot(center(i), center(j)) <= disc_radius) is_dark[i + N * j] = true;
  return double(std::count(is_dark.begin(), is_dark.end(), true)) * CELL * CELL;
}

// Waves of the rim, which is the last `n` points.
int count_folds(const std::vector<Vec3>& x, std::size_t n) {
  std::vector<double> r;
  for (std::size_t i = x.size() - n; i < x.size(); ++i) r.push_back(std::hypot(x[i].x(), x[i].y()));
  double mean = 0;
  for (const double value : r) mean += value / double(n);
  int crossings = 0;
  for (std::size_t i = 0; i < n; ++i) crossings += (r[i] > mean) != (r[(i + 1) % n] > mean);
  return crossings / 2;
}

struct Fabric {
  const char* name;
  double area_density, bending;  // [kg/m^2], [N m]
  double low, high;              // drape coefficients that such fabrics show [%]
};

// Fixed before the first run. Areal densities: Penava, Simic Penava and Knezic 2014, "Determination of the elastic
// constants of plain woven fabrics by a tensile test in various directions", table 1 (polyester, wool with lycra,
// cotton). Bending rigidities: Matsudaira, Masuda, Wada and Yokura 2015, J. Textile Eng. 61(6), table 1, KES-FB2
// (polyester faille 0.019, wool tropical 0.067, cotton broad 0.118 gf cm^2/cm).
constexpr Fabric FABRICS[] = {
    {"polyester", 0.1646, 1.863e-6, 20, 40}, {"wool", 0.1782, 6.570e-6, 40, 70}, {"cotton", 0.1503, 1.157e-5, 60, 76}};
constexpr double PLATE_RADIUS = 0.09;  // [m]
constexpr std::size_t RIM_POINTS = 72;

}  // namespace

void validate_heavy_cantilever_cloth(Validation& v) {
  // gamma and y / L, by quadrature
  const std::pair<double, double> rows[] = {{0.5, .06231}, {1, .12347},  {2, .23851},
                                            {5, .49591},   {10, .70020}, {20, .82988}};
  Plot plot{"heavy_cantilever_cloth", "Cloth strip under its own weight", "rho g L^3 / B", "drop / L", {}};
  plot.curves = {{"equal triangles", {}, {}}, {"irregular triangles", {}, {}}, {"expected", {}, {}, true}};
  for (const auto& [gamma, drop] : rows) {
    const double measured[] = {strip_drop(v, gamma, 0), strip_drop(v, gamma, 0.2), drop};
    const std::string name = "Gamma " + short_number(gamma);
    v.check_relative(name + ": drop", "L", drop, measured[0], 0.02, "heavy elastica");
    v.report(name + ", triangles irregular by 0.2: drop", "L", drop, measured[1], "heavy elastica");
    for (int i = 0; i < 3; ++i) plot.curves[i].x.push_back(gamma), plot.curves[i].y.push_back(measured[i]);
  }
  v.plot(std::move(plot));
}

void validate_drape(Validation& v) {
  Plot plot{"drape", "Rim of the draped fabrics from above", "x [m]", "y [m]", {}};
  for (const Fabric& fabric : FABRICS) {
    SceneRun run = v.load("drape");
    Cloth& cloth = run.scene.cloths[0];
    cloth.material.area_density = fabric.area_density;
    cloth.material.bending_warp = cloth.material.bending_weft = fabric.bending;
    const Rest rest = cloth_at_rest(v, run, 2e-5);
    const double plate = shadow_area({}, {}, PLATE_RADIUS),
                 flat = shadow_area(cloth.mesh.points, cloth.mesh.triangles, PLATE_RADIUS),
                 draped = shadow_area(rest.x, cloth.mesh.triangles, PLATE_RADIUS);
    const std::string name = fabric.name;
    v.check(name + ": drape coefficient", "%", (fabric.low + fabric.high) / 2, 100 * (draped - plate) / (flat - plate),
            (fabric.high - fabric.low) / 2, "range of such fabrics (BS 5058); weight: Penava 2014, B: Matsudaira 2015");
    v.report(name + ": speed at the end", "m/s", 0, rest.largest_move / run.scene.solver.time_step, "at rest");
    v.report(name + ": folds", "1", 7, count_folds(rest.x, RIM_POINTS), "5 to 8 are usual");
    Curve curve{name, {}, {}};
    for (std::size_t i = 0; i <= RIM_POINTS; ++i) {
      const Vec3& x = rest.x[rest.x.size() - RIM_POINTS + i % RIM_POINTS];
      curve.x.push_back(x.x()), curve.y.push_back(x.y());
    }
    plot.curves.push_back(curve);
  }
  v.plot(std::move(plot));
}

}  // namespace pvg
