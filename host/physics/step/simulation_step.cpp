#include <algorithm>
#include <cmath>
#include <utility>

#include "host/physics/energies/prescribed_motion.hpp"
#include "host/physics/step/extrapolation.hpp"
#include "host/physics/step/simulation_impl.hpp"

namespace pvg {
namespace {

constexpr int MAX_LINE_SEARCH = 40;  // halvings of one Newton step
constexpr int MAX_LAG_PASSES = 50;   // evaluations of the lagged friction, where it is to settle
constexpr int MANY_CG = 12;     // iterations take longer than to take the contacts into the preconditioner's factor
constexpr double ENOUGH = 0.1;  // of its first correction ends a pass there: what is lagged is not exact before

bool any(const std::vector<char>& worlds) {
  return std::any_of(worlds.begin(), worlds.end(), [](char is_in) { return is_in; });
}

}  // namespace

// From the start of the step to where the velocities lead, as far as no contact is in the way.
void Simulation::Impl::move_to_first_guess(double h) {
  std::vector<double> motion = extrapolated_motion(system, x.node.read(), integrator.velocity().read(), h);
  aim_prescribed(motion);
  dx.write(motion);
  for (std::size_t w = 0; w < is_intact.size(); ++w)
    if (const auto node = first_not_finite(dx, w); node && is_intact[w])
      give_up(w, StepEvent::Kind::not_finite, *node, "its velocity is not a number");
  move(std::vector<double>(is_intact.begin(), is_intact.end()));
  std::vector<double> certified = certify();
  for (std::size_t w = 0; w < is_intact.size(); ++w) certified[w] *= is_intact[w];
  // a guess that ends just short of touching would start Newton where the barrier is steepest
  for (double& length : certified)
    if (length < 1) length *= 0.5;
  move(certified);
  std::swap(x, trial);
}

// trial = x + length dx, per world
void Simulation::Impl::move(const std::vector<double>& length) {
  step.write(length);
  const u32 n = u32(system.n_nodes());
  move_along(n, n, node_world, step, x.node, dx, trial.node);
  potential.update_sites(trial);
}

// How much of the motion from x to trial is free of contact, per world.
std::vector<double> Simulation::Impl::certify() {
  {
    const auto timed = clock.time(SolverPhase::broad_phase);
    contacts.find_candidates(x.site, trial.site);
  }
  const auto timed = clock.time(SolverPhase::continuous_collision);
  return contacts.largest_step(x.site, trial.site);
}

void Simulation::Impl::find_contacts() {
  const auto timed = clock.time(SolverPhase::narrow_phase);
  contacts.find_contacts(x.site);
}

void Simulation::Impl::factorize() {
  const auto timed = clock.time(SolverPhase::preconditioner);
  while (const auto node = potential.factorize(is_active))
    give_up(system.node_world[*node], StepEvent::Kind::not_finite, *node,
            "the stiffness of what it belongs to is not positive definite");
}

// Takes contacts into the preconditioner's factor: where conjugate gradients took long they are what it lacks, and in a
// world where they once did every iteration of Newton's begins with them.
void Simulation::Impl::couple_contacts(const CgReport& report) {
  std::vector<char> took_long(is_active.size(), false);
  for (std::size_t w = 0; w < took_long.size(); ++w) took_long[w] = is_active[w] && report.iterations[w] > MANY_CG;
  const auto timed = clock.time(SolverPhase::preconditioner);
  potential.couple_contacts(took_long, Potential::Coupling::solve_took_long);
}

void Simulation::Impl::renew_couplings(Potential::Coupling when) {
  std::vector<char> once_took_long(is_active.size(), false);
  for (std::size_t w = 0; w < once_took_long.size(); ++w)
    once_took_long[w] = is_active[w] && !potential.couplings()[w].empty();
  const auto timed = clock.time(SolverPhase::preconditioner);
  potential.couple_contacts(once_took_long, when);
}

CgReport Simulation::Impl::solve() {
  const auto timed = clock.time(SolverPhase::solve);
  return cg.solve([&](const Buffer<f64>& p, Buffer<f64>& out) { potential.product(p, out); },
                  [&](const Buffer<f64>& r, Buffer<f64>& out) { potential.precondition(r, out); }, gradient, is_active,
                  solver().cg_tolerance, solver().max_cg, dx);
}

std::vector<double> Simulation::Impl::find_direction() {
  {
    const auto timed = clock.time(SolverPhase::assembly);
    potential.differentiate(x, contacts.contacts(), gradient);
  }
  renew_couplings(std::exchange(begins_step, false) ? Potential::Coupling::step_begins
                                                    : Potential::Coupling::before_solve);
  factorize();
  const CgReport report = solve();
  couple_contacts(report);
  for (std::size_t w = 0; w < reports.size(); ++w) {
    reports[w].cg += report.iterations[w];
    reports[w].newton += is_active[w];
    if (!is_active[w] || report.has_converged[w]) continue;
    if (const auto node = first_not_finite(gradient, w))
      give_up(w, StepEvent::Kind::not_finite, *node, "the force on it is not a number");
    else
      give_up(w, StepEvent::Kind::stalled, fastest_node(w),
              "conjugate gradients did not converge within " + std::to_string(solver().max_cg) + " iterations");
  }
  direction.node.copy_from(dx);
  potential.update_sites(direction);
  reduce.largest_length(speed_chunks, direction.site, largest);
  const std::vector<double> largest_move = largest.read();
  for (std::size_t w = 0; w < reports.size(); ++w)
    if (is_active[w] && !std::isfinite(largest_move[w]))
      give_up(w, StepEvent::Kind::not_finite, first_not_finite(dx, w).value_or(system.node_ranges[w].begin),
              "its correction is not a number");
  return largest_move;
}

// Moves to trial = x + length dx and finds its contacts. Returns its energy per world [J].
std::vector<double> Simulation::Impl::energy_at(const std::vector<double>& length) {
  move(length);
  contacts.find_contacts(trial.site);
  return potential.energy(trial, contacts.contacts());
}

// Halves each world's step until its energy does not rise. Contact was certified by `certified`, so no pair touches.
void Simulation::Impl::line_search(const std::vector<double>& certified) {
  const auto timed = clock.time(SolverPhase::line_search);
  const std::vector<double> before = energy;
  std::vector<double> length = certified;
  for (int halving = 0; halving < MAX_LINE_SEARCH; ++halving) {
    const std::vector<double> after = energy_at(length);
    bool all_fell = true;
    for (std::size_t w = 0; w < length.size(); ++w) {
      // a rise within rounding counts as none
      const bool fell = !is_active[w] || after[w] <= before[w] + 1e-12 * std::abs(before[w]);
      if (fell) continue;
      all_fell = false;
      length[w] /= 2;
      if (halving + 1 < MAX_LINE_SEARCH) continue;
      give_up(w, StepEvent::Kind::exhausted_line_search, fastest_node(w),
              "no decrease of the energy was found along it");
      length[w] = 0;
    }
    if (all_fell) {
      energy = after;
      std::swap(x, trial);
      return;
    }
  }
  energy = energy_at(length);
  std::swap(x, trial);
}

// Newton's method at the friction as it is lagged. A world is done where its correction is within the tolerance, or has
// fallen to `enough` of its first one while friction is lagged.
void Simulation::Impl::minimize(double h, bool may_be_settled, double enough) {
  is_active = is_unsettled;
  find_contacts();
  energy = potential.energy(x, contacts.contacts());
  std::vector<double> stop(is_active.size());  // [m/s]
  for (int iteration = 0; iteration < solver().max_newton && any(is_active); ++iteration) {
    const std::vector<double> largest_move = find_direction();
    for (std::size_t w = 0; w < is_active.size(); ++w) {
      if (!is_active[w]) continue;
      reports[w].residual = largest_move[w] / h;
      if (iteration > 0) continue;
      const double tolerance = system.scenes[w].solver.velocity_tolerance;
      const std::vector<u32>& first = contacts.friction().first;
      const bool has_friction = first[w + 1] > first[w];  // else there is no further pass that would go on
      stop[w] = has_friction ? std::max(tolerance, enough * reports[w].residual) : tolerance;
      if (may_be_settled && reports[w].residual <= tolerance) is_active[w] = is_unsettled[w] = false;
    }
    if (!any(is_active)) return;
    move(std::vector<double>(is_active.begin(), is_active.end()));
    std::vector<double> certified = certify();
    for (std::size_t w = 0; w < is_active.size(); ++w) certified[w] *= is_active[w];
    line_search(certified);
    for (std::size_t w = 0; w < is_active.size(); ++w)
      if (reports[w].residual <= stop[w]) is_active[w] = false;
  }
  for (std::size_t w = 0; w < is_active.size(); ++w)
    if (is_active[w])
      give_up(w, StepEvent::Kind::stalled, fastest_node(w),
              "Newton's method did not converge within " + std::to_string(solver().max_newton) +
                  " iterations, the last correction moved a point at " + std::to_string(reports[w].residual) + " m/s");
}

// Contacts at x and their friction: normal forces and tangents as they are here, for a step of length h. A world that
// had no friction and has none now is settled.
void Simulation::Impl::lag_friction(double h, const Positions& foreseen) {
  const std::vector<u32> before = contacts.friction().first;
  find_contacts();
  {
    const auto timed = clock.time(SolverPhase::narrow_phase);
    contacts.lag_friction(x.site, h, start.site, foreseen.site);
    potential.set_friction(contacts.friction());
  }
  const std::vector<u32>& now = contacts.friction().first;
  for (std::size_t w = 0; w < is_unsettled.size(); ++w)
    if (before[w] == before[w + 1] && now[w] == now[w + 1]) is_unsettled[w] = false;
}

// The minimum of the incremental potential, from x on. Renews the lagged friction, as often as is wanted or until it is
// settled: until at renewed friction the first correction is within the tolerance. Such a correction is not made, so
// that a world ends where its friction was evaluated.
void Simulation::Impl::find_minimum(double h) {
  const int wanted = system.scenes[0].contact.friction_lag_passes;
  {
    const auto timed = clock.time(SolverPhase::broad_phase);
    contacts.find_candidates(x.site, x.site);
  }
  lag_friction(h, predicted);
  is_unsettled = is_intact;
  move_to_first_guess(h);
  minimize(h, false, wanted < 0 ? ENOUGH : 0);
  for (int pass = 1; pass < (wanted < 0 ? MAX_LAG_PASSES : wanted) && any(is_unsettled); ++pass) {
    lag_friction(h, x);
    minimize(h, wanted < 0, wanted < 0 ? ENOUGH : 0);
  }
  for (std::size_t w = 0; wanted < 0 && w < is_unsettled.size(); ++w)
    if (is_unsettled[w])
      give_up(w, StepEvent::Kind::stalled, fastest_node(w),
              "friction did not settle within " + std::to_string(MAX_LAG_PASSES) +
                  " passes, the last one began with a point moving at " + std::to_string(reports[w].residual) + " m/s");
}

void Simulation::Impl::advance(double h, const std::vector<std::vector<double>>& previous,
                               const std::vector<std::vector<double>>& targets, const std::vector<char>& worlds,
                               bool goes_on) {
  is_intact = worlds;
  begins_step = true;
  length = h;
  start.node.copy_from(x.node);
  potential.update_sites(start);
  const double inertia_h = integrator.predict(start.node, h, solver().integrator, goes_on, predicted.node);
  prescribe(h);
  potential.update_sites(predicted);
  potential.begin_step(start, predicted, h, inertia_h);
  potential.set_forces(integrator.velocity());
  set_joints(h, previous, targets);
  find_minimum(h);
  give_up_inverted();
  integrator.accept(start.node, x.node, is_intact);
  contacts.renew_anchors(x.site, start.site, h, is_intact);
  potential.flow(x, h, is_intact);
  read_state(h);
}

std::vector<char> Simulation::Impl::advance_or_halve(double h, const std::vector<std::vector<double>>& previous,
                                                     const std::vector<std::vector<double>>& targets,
                                                     const std::vector<char>& worlds, int halvings_left) {
  std::vector<char> parts[2], failed(worlds.size(), false);
  for (const bool goes_on : {false, true})
    for (std::size_t w = 0; w < worlds.size(); ++w)
      parts[goes_on].push_back(worlds[w] && integrator.goes_on(w, h) == goes_on);
  for (const bool goes_on : {false, true}) {
    const std::vector<char>& part = parts[goes_on];
    if (!any(part)) continue;
    advance(h, previous, targets, part, goes_on);
    for (std::size_t w = 0; w < part.size(); ++w) failed[w] |= part[w] && !is_intact[w];
  }
  for (std::size_t w = 0; halvings_left > 0 && w < worlds.size(); ++w) {
    if (!failed[w]) continue;
    ++reports[w].retries;
    std::vector<std::vector<double>> middle = targets;
    for (std::size_t j = 0; j < middle[w].size(); ++j) middle[w][j] = 0.5 * (previous[w][j] + targets[w][j]);
    std::vector<char> alone(worlds.size(), false);
    alone[w] = true;
    failed[w] = advance_or_halve(h / 2, previous, middle, alone, halvings_left - 1)[w] ||
                advance_or_halve(h / 2, middle, targets, alone, halvings_left - 1)[w];
  }
  return failed;
}
void Simulation::Impl::prescribe(double h) {
  if (!has_prescribed) return;
  std::vector<double> nodes = predicted.node.read();
  for (std::size_t w = 0; w < system.n_worlds(); ++w) write_prescribed(system, w, states[w].time + h, nodes);
  predicted.node.write(nodes);
}

void Simulation::Impl::aim_prescribed(std::vector<double>& motion) {
  if (!has_prescribed) return;
  const std::vector<double> from = x.node.read(), to = predicted.node.read();
  for (std::size_t w = 0; w < system.n_worlds(); ++w)
    for (std::size_t b = 0; b < system.scenes[w].rigid_bodies.size(); ++b)
      if (system.scenes[w].rigid_bodies[b].is_prescribed)
        for (u32 i = 3 * system.rigid_first_node[w][b], end = i + 12; i < end; ++i) motion[i] = to[i] - from[i];
}

}  // namespace pvg
