// Soft solids against Hooke's law, the theory of beams and the elastica.
#include <algorithm>
#include <cmath>
#include <map>

#include "host/geometry/primitive_shapes.hpp"
#include "pipeline/validation/cases.hpp"

namespace pvg {
namespace {

constexpr double AT_REST = 1e-9;  // largest move of a node in a step [m]

// the state at the end, or where nothing moves any more
WorldState end_of(const Validation& v, const SceneRun& run) {
  WorldState last;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    double most = last.soft.empty() ? 1 : 0;
    for (std::size_t i = 0; i < state.soft[0].size() && most < AT_REST; ++i)
      most = std::max(most, (state.soft[0][i] - last.soft[0][i]).norm());
    last = state;
    return most >= AT_REST;
  });
  return last;
}

// mean displacement of the soft body's nodes whose rest coordinate along `axis` is `value`
Vec3 mean_move(const Scene& scene, const WorldState& state, int axis, double value) {
  const std::vector<Vec3>& rest = scene.soft_bodies[0].mesh.points;
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (std::abs(rest[i](axis) - value) > 1e-7) continue;
    sum += state.soft[0][i] - rest[i];
    ++n;
  }
  return sum / n;
}

// Displacement of the tip over the length, and how far it comes back, of beams of 100 mm that bend far.
struct Bent {
  double drop = 0, shortening = 0;
};

Bent bent(const Validation& v, const SceneRun& run) {
  const Vec3 move = mean_move(run.scene, end_of(v, run), 0, 0.05);
  return {-move.z() / 0.1, -move.x() / 0.1};
}

constexpr double BENDING_STIFFNESS = 1e7 * 0.00125 * 0.00125 * 0.00125 * 0.00125 / 12;  // E I of those [N m^2]

// alpha = P L^2 / (E I)
void set_load(SceneRun& run, double alpha) {
  RigidBody& weight = run.scene.rigid_bodies[rigid_index(run.scene, "weight")];
  const double mass = alpha * BENDING_STIFFNESS / 0.01 / 9.81;
  weight.inertia *= mass / weight.mass;
  weight.mass = mass;
}

}  // namespace

std::string short_number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  return text.ends_with('.') ? text + "0" : text;
}

void set_divisions(SceneRun& run, const Vec3& size, const std::array<int, 3>& divisions, int nodes_per_element) {
  TetMesh& mesh = run.scene.soft_bodies[0].mesh;
  const TetMesh old = mesh;
  mesh = box_solid(size, divisions, nodes_per_element);
  for (Stitch& stitch : run.scene.stitches) {
    Vec3 low = old.points[stitch.nodes.at(0)], high = low;
    for (const std::uint32_t node : stitch.nodes) {
      low = low.cwiseMin(old.points[node]);
      high = high.cwiseMax(old.points[node]);
    }
    stitch.nodes.clear();
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      const Vec3& p = mesh.points[i];
      if ((p.array() > low.array() - 1e-7).all() && (p.array() < high.array() + 1e-7).all())
        stitch.nodes.push_back(std::uint32_t(i));
    }
  }
}

void validate_tensile(Validation& v) {
  Plot plot{"tensile", "Bar on rollers, strain 0.05 %", "Poisson's ratio given", "measured / given", {}};
  plot.curves = {{"Young's modulus", {}, {}}, {"Poisson's ratio", {}, {}}, {"exact", {}, {}, true}};
  for (const double nu : {0.3, 0.45, 0.49, 0.499}) {
    SceneRun run = v.load("tensile");
    run.scene.soft_bodies[0].material.poisson_ratio = nu;
    const WorldState last = end_of(v, run);
    const double length = mean_move(run.scene, last, 0, 0.05).x() - mean_move(run.scene, last, 0, -0.05).x();
    const double width = mean_move(run.scene, last, 1, 0.01).y() - mean_move(run.scene, last, 1, -0.01).y();
    const double strain = length / 0.1;
    const std::string name = "nu " + short_number(nu);
    const double modulus = last.joint_effort[0] / 0.0004 / strain, ratio = -width / 0.02 / strain;
    v.check_relative(name + ": Young's modulus", "Pa", 1e6, modulus, 0.01, "given");
    v.check(name + ": Poisson's ratio", "1", nu, ratio, 0.01, "given");
    const double shown[] = {modulus / 1e6, ratio / nu, 1};
    for (int i = 0; i < 3; ++i) plot.curves[i].x.push_back(nu), plot.curves[i].y.push_back(shown[i]);
  }
  v.plot(std::move(plot));
}

void validate_rib(Validation& v) {
  // F L^3 / (3 E I)
  const double expected = 2e-5 * 10 * 8e-6 / (3 * 1e6 * 0.004 * 8e-9 / 12);
  const std::map<double, double> shares = {{0.45, 0.10}, {0.49, 0.20}, {0.499, 0.20}};
  const std::vector<std::array<int, 3>> meshes = {{5, 1, 1}, {10, 2, 1}, {20, 4, 2}};
  Plot plot{"rib", "Rib 20 x 4 x 2 mm: tip deflection by beam theory's", "cells along the rib", "ratio", {}};
  for (const auto& [nu, share] : shares) {
    Curve curve{"nu " + short_number(nu), {}, {}};
    for (const std::array<int, 3>& divisions : meshes) {
      if (v.is_quick && divisions[0] != 10) continue;
      SceneRun run = v.load("rib");
      run.scene.soft_bodies[0].material.poisson_ratio = nu;
      set_divisions(run, Vec3(0.02, 0.004, 0.002), divisions, 10);
      const double tip = -mean_move(run.scene, end_of(v, run), 0, 0.01).z();
      curve.x.push_back(divisions[0]);
      curve.y.push_back(tip / expected);
      const std::string name = curve.label + ", " + std::to_string(divisions[0]) + " cells: deflection";
      if (divisions[0] == 10)
        v.check_relative(name, "m", expected, tip, share, "F L^3 / (3 E I)");
      else
        v.report(name, "m", expected, tip, "F L^3 / (3 E I)");
    }
    plot.curves.push_back(curve);
  }
  v.plot(std::move(plot));
}

namespace {

// What one load, alpha = 5, does to coarser meshes and a finer one.
void validate_elastica_meshes(Validation& v, double expected, double with_60_cells) {
  Curve error{"simulated", {}, {}}, wanted{"1 %", {}, {}, true};
  for (const int cells : {10, 20, 40}) {
    SceneRun run = v.load("elastica");
    set_divisions(run, Vec3(0.1, 0.00125, 0.00125), {cells, 1, 1}, 10);
    set_load(run, 5);
    const double drop = bent(v, run).drop;
    v.report("alpha 5, " + std::to_string(cells) + " cells: drop", "L", expected, drop, "elastica");
    error.x.push_back(cells), error.y.push_back(100 * std::abs(drop / expected - 1));
  }
  error.x.push_back(60), error.y.push_back(100 * std::abs(with_60_cells / expected - 1));
  wanted.x = {10, 60}, wanted.y = {1, 1};
  v.plot({"elastica_convergence",
          "Elastica, P L^2 / (E I) = 5: convergence",
          "cells along the beam",
          "error of the tip's drop [%]",
          {error, wanted},
          true,
          true});
}

}  // namespace

void validate_elastica(Validation& v) {
  struct Row {
    double alpha, drop, shortening;
  };
  // end-loaded elastica by quadrature; alpha = P L^2 / (E I)
  const Row rows[] = {{0.25, .08275, .00412}, {0.5, .16214, .01592}, {1, .30172, .05643}, {2, .49346, .16064},
                      {3, .60325, .25442},    {5, .71379, .38763},   {10, .81061, .55500}};
  Plot plot{"elastica", "Elastica", "P L^2 / (E I)", "drop / L, shortening / L", std::vector<Curve>(4)};
  const char* labels[] = {"drop", "drop, expected", "shortening", "shortening, expected"};
  for (int i = 0; i < 4; ++i) plot.curves[i].label = labels[i], plot.curves[i].is_reference = i % 2 == 1;
  for (const auto& [alpha, drop, shortening] : rows) {
    SceneRun run = v.load("elastica");
    set_load(run, alpha);
    const Bent result = bent(v, run);
    const std::string name = "alpha " + short_number(alpha);
    v.check_relative(name + ": drop", "L", drop, result.drop, 0.01, "elastica");
    v.check_relative(name + ": shortening", "L", shortening, result.shortening, 0.01, "elastica");
    const double values[] = {result.drop, drop, result.shortening, shortening};
    for (int i = 0; i < 4; ++i) plot.curves[i].x.push_back(alpha), plot.curves[i].y.push_back(values[i]);
  }
  validate_elastica_meshes(v, .71379, plot.curves[0].y[5]);
  v.plot(std::move(plot));
}

void validate_heavy_cantilever(Validation& v) {
  // w L^3 / (E I) and y / L, by quadrature
  const std::pair<double, double> rows[] = {{0.5, .06231}, {1, .12347},  {2, .23851},
                                            {5, .49591},   {10, .70020}, {20, .82988}};
  Plot plot{"heavy_cantilever", "Cantilever under its own weight", "w L^3 / (E I)", "drop / L", std::vector<Curve>(2)};
  plot.curves[0].label = "simulated";
  plot.curves[1].label = "expected";
  plot.curves[1].is_reference = true;
  for (const auto& [gamma, drop] : rows) {
    SceneRun run = v.load("heavy_cantilever");
    run.scene.soft_bodies[0].material.density = gamma * BENDING_STIFFNESS / (0.00125 * 0.00125 * 9.81 * 1e-3);
    const double measured = bent(v, run).drop;
    v.check_relative("Gamma " + short_number(gamma) + ": drop", "L", drop, measured, 0.02, "heavy elastica");
    plot.curves[0].x.push_back(gamma), plot.curves[0].y.push_back(measured);
    plot.curves[1].x.push_back(gamma), plot.curves[1].y.push_back(drop);
  }
  v.plot(std::move(plot));
}

}  // namespace pvg
