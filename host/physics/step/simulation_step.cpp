#include <algorithm>
#include <cmath>
#include <utility>

#include "host/physics/step/simulation_impl.hpp"

namespace pvg {
namespace {

constexpr int MAX_LAG_PASSES = 50;  // evaluations of the lagged friction, where it is to settle
constexpr int MANY_CG = 12;         // iterations take longer than to take the contacts into the preconditioner's factor
// The matrix of an iteration without contact serves for the next one where its correction was at most so many
// tolerances, and goes on to serve where corrections fall to this part of the last one
// (docs/measured/2026-11-28_step_2.md).
constexpr double NEAR = 15, FALLS = 0.3;
constexpr double ENOUGH =
    0.1;  // of its first correction ends a pass while friction is to settle: it is lagged anew then

}  // namespace

// Takes contacts into the preconditioner's factor: where conjugate gradients took long they are what it lacks, and in a
// world where they once did every iteration of Newton's begins with them.
void Simulation::Impl::couple_contacts(const CgReport& report) {
  std::vector<char> took_long(is_active.size(), false);
  for (std::size_t w = 0; w < took_long.size(); ++w) took_long[w] = is_active[w] && report.iterations[w] > MANY_CG;
  const auto timed = clock.time(SolverPhase::preconditioner);
  potential.couple_contacts(took_long, Potential::Coupling::solve_took_long);
}

void Simulation::Impl::renew_couplings(Potential::Coupling when) {
  const auto timed = clock.time(SolverPhase::preconditioner);
  potential.couple_contacts(coupled_worlds(), when);
}

std::vector<char> Simulation::Impl::coupled_worlds() const {
  std::vector<char> once_took_long(is_active.size(), false);
  for (std::size_t w = 0; w < once_took_long.size(); ++w)
    once_took_long[w] = is_active[w] && !keeps_matrix[w] && !potential.couplings()[w].empty();
  return once_took_long;
}

void Simulation::Impl::start_solve() {
  const auto timed = clock.time(SolverPhase::solve);
  if (!device.info().runs_host_functions && std::size_t(n_directions) <= solves_before.size())
    cg.expect(solves_before[std::size_t(n_directions) - 1]);
  // late in a step contacts mostly stay, and of a first guess they are read: there is time to ask
  contacts.read_sites(potential.reads_contacts() && !potential.can_foresee_contacts());
  cg.start(potential.operators(), gradient, is_active, solver().cg_tolerance, solver().max_cg, dx,
           std::exchange(has_begun_solve, false));
}

// Factor, solve and move as far as is certified; nothing where the first guess, which x is, did not come as foreseen.
// On the host's own processor, where waiting is cheap, the host looks how far conjugate gradients came before it starts
// what follows; elsewhere all is started at once if the last solve was short, and what was started too early again.
// Whether the factor succeeded shows only then: a world where it did not is given up, the others are solved without it.
std::optional<CgReport> Simulation::Impl::factorize_and_solve(double h, bool settles) {
  const bool waits_for_solve = device.info().runs_host_functions;
  for (;;) {
    {
      const auto timed = clock.time(SolverPhase::preconditioner);
      potential.start_factorize(is_active, &gradient, keeps_matrix);
    }
    if (n_halvings > 0) keep_energy_before();
    start_solve();
    for (;;) {
      const auto timed = clock.time(SolverPhase::solve);
      const bool looks_ahead = waits_for_solve ? cg.may_have_ended() : cg.is_short() || cg.is_near_end();
      const auto move_ahead = [&] {
        start_look_ahead();
        if (!waits_for_solve) start_trial(settles, h);
      };
      if (looks_ahead) move_ahead();
      device.finish();
      if (!first_guess_holds()) return std::nullopt;
      if (!cg.ended()) {
        cg.go_on();
        continue;
      }
      if (!looks_ahead) {
        move_ahead();
        device.finish();
      }
      break;
    }
    if (const auto node = potential.failed()) {
      give_up(system.node_world[*node], StepEvent::Kind::not_finite, *node,
              "the stiffness of what it belongs to is not positive definite");
      continue;
    }
    if (!waits_for_solve && contacts.candidates_serve()) return cg.report();
    if (waits_for_solve && !contacts.candidates_serve()) {
      const auto timed = clock.time(SolverPhase::broad_phase);
      contacts.renew_candidates(x.site, trial.site);
    }
    const auto timed = clock.time(SolverPhase::line_search);
    if (!waits_for_solve) {
      move(full_step);
      contacts.start_renew_candidates(x.site, trial.site, contacts.lacking_candidates());
      start_trial(settles, h);
      device.finish();
      const bool is_done = contacts.candidates_serve();
      if (!is_done) move(full_step);
      contacts.renew_candidates(x.site, trial.site);
      if (is_done) return cg.report();
    }
    start_trial(settles, h);
    device.finish();
    return cg.report();
  }
}

bool Simulation::Impl::has_contact(std::size_t w) const {
  const auto has = [w](const std::vector<u32>& first) { return first[w + 1] > first[w]; };
  return has(contacts.contacts().first) || has(contacts.friction().first);
}

// Worlds whose elements' Hessians and factor are to be made anew; empty: all. Where little is left of a step they
// change little, so the last ones serve for a correction more; not at contact, whose part in the factor changes much.
// Factors of a device are not kept: all are lost where the pattern of one changes. Worlds that are done are left out
// too, but for a device apart from the host, which takes all at once.
std::vector<char> Simulation::Impl::wanted_matrices() {
  if (begins_step) {
    may_keep_matrix.assign(is_active.size(), false);
    last_speed.assign(is_active.size(), 0);
  }
  keeps_matrix.assign(is_active.size(), false);
  for (std::size_t w = 0; w < is_active.size(); ++w)
    keeps_matrix[w] = is_active[w] && may_keep_matrix[w] && !has_contact(w) && potential.keeps_factors(u32(w));
  if (!device.info().runs_host_functions && !any(keeps_matrix)) return {};
  std::vector<char> wanted = is_active;
  for (std::size_t w = 0; w < wanted.size(); ++w) wanted[w] = wanted[w] && !keeps_matrix[w];
  return wanted;
}

std::optional<CgReport> Simulation::Impl::solve_direction(double h, bool settles) {
  {
    const auto timed = clock.time(SolverPhase::assembly);
    has_begun_solve = potential.differentiate(x, contacts, gradient, wanted_matrices(), &dx, &cg.residual());
  }
  if (!is_guess_foreseen)  // else they are thought to stay
    renew_couplings(begins_step ? Potential::Coupling::step_begins : Potential::Coupling::before_solve);
  return factorize_and_solve(h, settles);
}

bool Simulation::Impl::find_direction(double h, bool settles) {
  // As many halvings as this direction of the last step took are started ahead of the next look, but for the host's own
  // processor. What contact makes of steps goes on from one to the next: in 420 steps of weigh_beaker 187 of 654
  // directions were halved, mostly as often as that of the step before (docs/measured/2026-11-28_counts.md).
  const bool looks_often = device.info().runs_host_functions;
  halvings.resize(std::size_t(n_directions), 0);
  n_halvings = looks_often || halvings.size() >= halvings_before.size() ? 0 : halvings_before[halvings.size()];
  ++n_directions;
  has_read_end = false;
  std::optional<CgReport> solved = solve_direction(h, settles);
  if (!solved) {
    repeat_first_guess(h);
    solved = solve_direction(h, settles);
  }
  const CgReport& report = *solved;
  begins_step = false;
  ++counts.newton;
  solves.push_back(*std::max_element(report.iterations.begin(), report.iterations.end()));
  counts.cg += std::size_t(solves.back());
  couple_contacts(report);
  for (std::size_t w = 0; w < reports.size(); ++w) {
    if (!is_active[w]) continue;
    const double speed = largest_move[w] / h;
    may_keep_matrix[w] = report.has_converged[w] && speed <= NEAR * least_stop[w] && !has_contact(w) &&
                         report.iterations[w] <= MANY_CG && (!keeps_matrix[w] || speed <= FALLS * last_speed[w]);
    last_speed[w] = speed;
  }
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
  for (std::size_t w = 0; w < reports.size(); ++w)
    if (is_active[w] && !std::isfinite(largest_move[w]))
      give_up(w, StepEvent::Kind::not_finite, first_not_finite(dx, w).value_or(system.node_ranges[w].begin),
              "its correction is not a number");
  contacts.take_contacts();
  return is_active == active_written;
}

// Newton's method at the friction as it is lagged. A world is done where its correction is within the tolerance, or has
// fallen to `enough` of its first one while friction is lagged.
void Simulation::Impl::minimize(double h, bool may_be_settled, double enough) {
  is_active = is_unsettled;
  std::vector<double> stop(is_active.size());  // [m/s]
  for (int iteration = 0; iteration < solver().max_newton && any(is_active); ++iteration) {
    const bool foreseen = find_direction(h, may_be_settled && iteration == 0);
    for (std::size_t w = 0; w < is_active.size(); ++w) {
      if (!is_active[w]) continue;
      reports[w].residual = largest_move[w] / h;
      if (iteration > 0) continue;
      const double least = least_stop[w];
      const std::vector<u32>& first = contacts.friction().first;
      const bool has_friction = first[w + 1] > first[w];  // else there is no further pass that would go on
      stop[w] = has_friction ? std::max(least, enough * reports[w].residual) : least;
      if (may_be_settled && reports[w].residual <= least) is_active[w] = is_unsettled[w] = false;
    }
    if (!any(is_active)) return;
    if (!foreseen) {
      move(std::vector<double>(is_active.begin(), is_active.end()));
      certified = certify();
      for (std::size_t w = 0; w < is_active.size(); ++w) certified[w] *= is_active[w];
    }
    line_search(foreseen);
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
void Simulation::Impl::lag_friction(double h, const Positions& foreseen, bool is_started) {
  has_read_end = false;
  const std::vector<u32> before = contacts.friction().first;
  {
    const auto timed = clock.time(SolverPhase::narrow_phase);
    if (is_started)
      contacts.take_friction(h, start.site, foreseen.site);
    else
      contacts.find_and_lag_friction(x.site, h, start.site, foreseen.site);
    potential.set_friction(contacts);
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
  if (!knows_motion) {  // else x is where the candidates served last
    const auto timed = clock.time(SolverPhase::broad_phase);
    contacts.find_candidates(x.site, x.site);
  }
  lag_friction(h, predicted, knows_motion);
  is_unsettled = is_intact;
  move_to_first_guess(h);
  minimize(h, false, wanted < 0 ? ENOUGH : 0);
  for (int pass = 1; pass < (wanted < 0 ? MAX_LAG_PASSES : wanted) && any(is_unsettled); ++pass) {
    lag_friction(h, x, false);
    energy = potential.energy(x, contacts);
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
  inertia_length = integrator.begin_step(x.node, h, solver().integrator, goes_on, potential.sites(), start, predicted);
  prescribe(h);
  potential.begin_step(start, predicted, h, inertia_length);
  push(h, goes_on);
  potential.set_forces(integrator.velocity());
  set_joints(h, previous, targets);
  n_directions_before = std::exchange(n_directions, 0);
  std::swap(halvings_before, halvings);
  halvings.clear();
  std::swap(solves_before, solves);
  solves.clear();
  find_minimum(h);
  if (!has_read_end) {
    start_read_end(x);
    device.finish();
  }
  give_up_inverted();
  integrator.accept(start.node, x.node, is_intact);
  std::swap(velocities_two_before, velocities_before);
  std::swap(velocities_before, velocities);
  velocities = integrator.velocities(nodes_before, start_nodes, nodes);
  std::swap(nodes_before, start_nodes);
  contacts.lagged().take_anchors(is_intact);
  knows_motion = std::all_of(is_intact.begin(), is_intact.end(), [](char intact) { return intact; });
  potential.flow(x, h, is_intact);
  read_state(h);
  restitute();
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

}  // namespace pvg
