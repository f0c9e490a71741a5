#include "pipeline/validation/validation.hpp"

#include <cmath>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {

SceneRun Validation::load(const std::string& scene) const { return load_scene_run(scenes_ / (scene + ".yaml")); }

void Validation::run(const SceneRun& run, const Observe& observe) const {
  Simulation simulation(device, run.scene);
  const StepCheck check(run.scene);
  const std::size_t n = run.n_steps();
  for (std::size_t step = 1; step <= n; ++step) {
    stop_if_asked();
    const StepReport report = simulation.step(run.targets_at(double(step) * run.scene.solver.time_step));
    check.look(simulation.state(), report, counts);
    if (!observe(simulation.state(), report)) return;
  }
}

void Validation::stop_if_asked() const {
  if (stop_) throw TryAgain("stopped before all cases were done");
}

void Validation::add_step_rows() {
  const std::string steps = counted(counts.steps, "step");
  const std::string first = counts.first_fault.empty() ? "" : "; first: " + counts.first_fault;
  if (counts.has_contact)
    check("intersections", "steps", 0, counts.intersecting, 0, "exact test at each of " + steps + first);
  if (counts.has_solids) check("inverted tetrahedra", "1", 0, counts.inverted, 0, "at each of " + steps + first);
  if (counts.steps > 0) check("steps not converged", "steps", 0, counts.unconverged, 0, "of " + steps + first);
  counts = {};
}

void Validation::check(const std::string& quantity, const std::string& unit, double expected, double measured,
                       double tolerance, const std::string& source) {
  rows.push_back({{}, quantity, unit, expected, measured, tolerance, source, ValidationRow::Kind::must, 0});
}

void Validation::check_relative(const std::string& quantity, const std::string& unit, double expected, double measured,
                                double share, const std::string& source) {
  check(quantity, unit, expected, measured, share * std::abs(expected), source);
}

void Validation::check_at_most(const std::string& quantity, const std::string& unit, double measured, double limit,
                               const std::string& source) {
  check(quantity, unit, 0, measured, limit, source);
}

void Validation::check_true(const std::string& statement, bool holds, const std::string& source) {
  check(statement, "1: yes", 1, holds ? 1 : 0, 0, source);
}

void Validation::report(const std::string& quantity, const std::string& unit, double expected, double measured,
                        const std::string& source) {
  rows.push_back({{}, quantity, unit, expected, measured, 0, source, ValidationRow::Kind::report, 0});
}

namespace {

template <class Body>
int index_of(const std::vector<Body>& bodies, const std::string& name) {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].name == name) return int(i);
  throw UsageError("the scene of a validation case has no body " + name);
}

}  // namespace

int rigid_index(const Scene& scene, const std::string& name) { return index_of(scene.rigid_bodies, name); }
int soft_index(const Scene& scene, const std::string& name) { return index_of(scene.soft_bodies, name); }

}  // namespace pvg
