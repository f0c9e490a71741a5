// Contact: the pressed sphere against the theory of elasticity, and scenes that are hard on a contact solver.
#include <algorithm>
#include <cmath>

#include "host/geometry/primitive_shapes.hpp"
#include "pipeline/validation/cases.hpp"
#include "pipeline/validation/pressed_sphere.hpp"
#include "pipeline/validation/state_hash.hpp"

namespace pvg {
namespace {

constexpr double RADIUS = 0.05;       // of the sphere [m]
constexpr double BALL_GRADING = 1.8;  // of its mesh, as in the scene

// Approach of a plane to the sphere's mid-plane [m], and the force of the whole sphere [N].
struct Press {
  double indentation = 0, force = 0;
};

Press press_of(const Scene& scene, const WorldState& state) {
  const int plate = rigid_index(scene, "plate");
  double force = 0, gap = 0;  // the gap at which the contact acts is no indentation
  for (const ContactForce& contact : state.contacts) {
    if (contact.first != plate && contact.second != plate) continue;
    const double part = contact.normal_force * std::abs(contact.normal.z());
    force += part;
    gap += part * contact.gap;
  }
  const double lower_face = state.rigid[plate](2, 3) - 0.0025;
  return force > 0 ? Press{RADIUS - (lower_face - gap / force), 4 * force} : Press{};
}

// The sphere in divisions^3 cells per octant, pressed by 1 mm and, if it goes on, by 2 mm: the ends of the two holds.
std::vector<Press> pressed(const Validation& v, int divisions, bool goes_on, Curve& curve) {
  SceneRun run = v.load("hertz");
  run.scene.soft_bodies[0].mesh = ball_octant_solid(RADIUS, divisions, BALL_GRADING, 10);
  const std::vector<Vec3>& rest = run.scene.soft_bodies[0].mesh.points;
  for (Stitch& stitch : run.scene.stitches) {  // rollers in the plane across their direction
    stitch.nodes.clear();
    for (std::size_t i = 0; i < rest.size(); ++i)
      if (std::abs(rest[i].dot(stitch.direction)) < 1e-9) stitch.nodes.push_back(std::uint32_t(i));
  }
  const std::size_t half = run.n_steps() / 2;
  if (!goes_on) run.duration /= 2;
  std::vector<Press> held;
  std::size_t step = 0;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    const Press press = press_of(run.scene, state);
    if (++step % half == 0) held.push_back(press);
    curve.x.push_back(1e3 * press.indentation);
    curve.y.push_back(press.force);
    return true;
  });
  return held;
}

// as if the indentation were `wanted`: F ~ indentation^1.5 nearby
double force_at(const Press& press, double wanted) { return press.force * std::pow(wanted / press.indentation, 1.5); }

// 4/3 E / (1 - nu^2) sqrt(R) d^1.5 of a half-space (Hertz 1882) [N]
double hertz_force(double indentation) {
  return 4.0 / 3 * 1e6 / (1 - 0.3 * 0.3) * std::sqrt(RADIUS) * std::pow(indentation, 1.5);
}

// Runs a scene twice; the state at the end. That nothing intersects, inverts or fails to converge is looked at in every
// run of every case.
WorldState run_twice(Validation& v, const SceneRun& run) {
  StateHash hash[2];
  WorldState last;
  for (StateHash& each : hash)
    v.run(run, [&](const WorldState& state, const StepReport&) {
      each.add(state);
      last = state;
      return true;
    });
  v.check_true("two runs, the same bits in every step", hash[0].value() == hash[1].value(), "deterministic");
  return last;
}

}  // namespace

void validate_hertz(Validation& v) {
  const double expected = 11.24;  // linear finite elements of this very set-up; of a half-space: 10.36 N
  const PressedSphere finite{RADIUS, 1e6, 0.3};
  const double at_1_mm_finite = pressing_force(finite, 1e-3);
  const std::string linear_source = "linear finite elements of this set-up",
                    finite_source = "finite strains, axisymmetric";
  Plot force{"hertz_force", "Sphere between two planes", "indentation to the mid-plane [mm]", "force [N]", {}};
  Plot convergence{
      "hertz", "Sphere between two planes, 1 mm: convergence", "cells along an octant's edge", "force / 11.24 N", {}};
  Curve ratio{"simulated", {}, {}}, one{"linear finite elements", {}, {}, true}, less{finite_source, {}, {}, true};
  for (const int divisions : {4, 6, 8}) {
    Curve curve{std::to_string(divisions) + " cells", {}, {}};
    const bool is_finest = divisions == 8;
    const std::vector<Press> held = pressed(v, divisions, is_finest, curve);
    const double at_1_mm = force_at(held.at(0), 1e-3);
    const std::string name = std::to_string(divisions) + " cells: force at 1 mm";
    if (is_finest)
      v.check_relative(name, "N", expected, at_1_mm, 0.03, linear_source);
    else
      v.report(name, "N", expected, at_1_mm, linear_source);
    if (is_finest)
      v.report("force at 2 mm", "N", pressing_force(finite, 2e-3), force_at(held.at(1), 2e-3), finite_source);
    ratio.x.push_back(divisions), ratio.y.push_back(at_1_mm / expected);
    one.x.push_back(divisions), one.y.push_back(1);
    less.x.push_back(divisions), less.y.push_back(at_1_mm_finite / expected);
    force.curves.push_back(std::move(curve));
  }
  // the facets' error falls with the square of their size
  const double last = ratio.y[2], before = ratio.y[1], limit = last + (last - before) / (64.0 / 36 - 1);
  v.check_relative("6 and 8 cells, continued to infinitely many: force at 1 mm", "N", at_1_mm_finite, limit * expected,
                   0.01, finite_source);
  convergence.curves = {ratio, one, less};
  Curve half_space{"Hertz, half-space", {}, {}, true};
  for (int i = 0; i <= 40; ++i) half_space.x.push_back(0.05 * i), half_space.y.push_back(hertz_force(5e-5 * i));
  force.curves.push_back(half_space);
  v.plot(std::move(convergence));
  v.plot(std::move(force));
}

void validate_squeeze_out(Validation& v) {
  const WorldState last = run_twice(v, v.load("squeeze_out"));
  const auto is_below = [](const Vec3& x) { return x.z() < -0.01; };
  const double share =
      double(std::count_if(last.soft[0].begin(), last.soft[0].end(), is_below)) / double(last.soft[0].size());
  // what comes through by this travel is nobody's known number
  v.report("share of the lower block's nodes below the slot", "1", 0.5, share, "half of it, for comparison");
}

void validate_knives(Validation& v) {
  const WorldState last = run_twice(v, v.load("knives"));
  double lowest = 1;
  for (const Vec3& x : last.soft[0]) lowest = std::min(lowest, x.z());
  v.check_true("the mat hangs on the blades", lowest > -0.03 && lowest < 0.003, "it cannot fall through");
}

void validate_slots(Validation& v) {
  const SceneRun run = v.load("slots");
  const WorldState last = run_twice(v, run);
  const double n = double(run.n_steps()), h = run.scene.solver.time_step;
  const int upright = rigid_index(run.scene, "upright");
  v.check_relative("way of the key that nothing touches", "m", n * h + 9.80665 * h * h * n * (n + 1) / 2,
                   run.scene.rigid_bodies[upright].pose.translation().z() - last.rigid[upright](2, 3), 1e-6,
                   "free fall from 1 m/s");
}

void validate_twist(Validation& v) {
  const WorldState last = run_twice(v, v.load("twist"));
  v.check_relative("twist of the mat", "turns", 4,
                   (last.joint_position[1] - last.joint_position[0]) / (2 * std::acos(-1.0)), 1e-3, "told");
}

void validate_touching(Validation& v) {
  const SceneRun run = v.load("touching");
  const WorldState last = run_twice(v, run);
  double worst = 0;  // sideways, of what is exactly aligned
  for (const char* name : {"stack_0", "stack_1", "stack_2"})
    worst = std::max(worst, last.rigid[rigid_index(run.scene, name)].col(3).head<2>().norm());
  v.check_at_most("the aligned stack stays aligned", "m", worst, 1e-4, "symmetric");
}

}  // namespace pvg
