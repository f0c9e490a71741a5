// The first guess of a step: from its start to where the velocities lead, as far as no contact is in the way.
//
// On a device apart from the host a wait takes longer than most of what follows, so the first direction of Newton's
// method is started from the guess before the host knows it: how many contacts there are, whether the candidates served
// and whether the factor's pattern holds. All of it is told by the wait for the direction. If it did not come so, which
// is rare, guess and direction are started again.
#include <algorithm>
#include <utility>

#include "host/physics/energies/prescribed_motion.hpp"
#include "host/physics/step/driven_motion.hpp"
#include "host/physics/step/extrapolation.hpp"
#include "host/physics/step/simulation_impl.hpp"

namespace pvg {
namespace {

// A guess that ends just short of touching would start Newton where the barrier is steepest.
constexpr double SHORT_OF = 0.5;

}  // namespace

// Where the velocities lead [n_nodes x 3, m].
std::vector<double> Simulation::Impl::first_motion(double h) {
  if (!knows_motion) {
    x.node.read_later(0, std::span(nodes));
    integrator.position_before().read_later(0, std::span(nodes_before));
    integrator.velocity().read_later(0, std::span(velocities));
    integrator.velocity_before().read_later(0, std::span(velocities_before));
    integrator.velocity_two_before().read_later(0, std::span(velocities_two_before));
    device.finish();
  }
  std::vector<char> goes_on;
  for (std::size_t w = 0; w < is_intact.size(); ++w) goes_on.push_back(integrator.goes_on(w, h));
  std::vector<double> motion = extrapolated_motion(
      system, nodes, extrapolated_velocities(system, velocities, velocities_before, velocities_two_before, goes_on), h);
  follow_drives(goes_on, h, motion);
  if (h == this->h()) take_expected(motion);
  aim_prescribed(motion);
  start_nodes = nodes;  // which are read anew at the end of the step
  return motion;
}

// Moves x there, and finds its energy and its contacts; or starts to, then first_guess_holds() is asked after the next
// wait.
void Simulation::Impl::move_to_first_guess(double h) {
  guessed_motion = first_motion(h);
  for (std::size_t w = 0; w < is_intact.size(); ++w) {
    const auto node = first_not_finite(guessed_motion, w);
    if (!node) continue;
    if (is_intact[w]) give_up(w, StepEvent::Kind::not_finite, *node, "its velocity is not a number");
    const WorldRange& range = system.node_ranges[w];
    std::fill(guessed_motion.begin() + 3 * std::ptrdiff_t(range.begin),
              guessed_motion.begin() + 3 * std::ptrdiff_t(range.end), 0.0);
  }
  dx.write(guessed_motion);
  contacts.read_sites(potential.reads_contacts());
  if (!device.info().runs_host_functions) return start_first_guess(h);
  {
    const auto timed = clock.time(SolverPhase::broad_phase);
    start_move(is_intact);
    device.finish();
    contacts.renew_candidates(x.site, trial.site);
  }
  finish_first_guess(h);
}

void Simulation::Impl::finish_first_guess(double h) {
  const auto timed = clock.time(SolverPhase::continuous_collision);
  start_certified_move(false, h, SHORT_OF);
  device.finish();
  contacts.take_contacts();
  std::swap(x, trial);
  energy = moved_energy;
}

// A whole step's motion is often more than the candidates serve for. That is foreseen from the last step: what follows
// is started, with lists that are looked for if they lacked there.
void Simulation::Impl::start_first_guess(double h) {
  const auto timed = clock.time(SolverPhase::broad_phase);
  start_move(is_intact);
  if (any(lacking_at_guess)) {
    contacts.start_check(x.site, trial.site);  // of the lists as they are
    contacts.start_renew_candidates(x.site, trial.site, lacking_at_guess);
  }
  start_certified_move(false, h, SHORT_OF);
  if (potential.can_foresee_contacts() && any(is_intact)) {
    contacts.foresee();
    std::swap(energy, moved_energy);  // where the device writes to
    std::swap(x, trial);
    std::swap(trial, before_guess);  // which the guess goes out from again, if it must
    is_guess_foreseen = true;
    return;
  }
  device.finish();
  const bool is_done = contacts.candidates_serve();
  if (!is_done) move(full_step);
  lacking_at_guess = contacts.renew_candidates(x.site, trial.site);
  if (!is_done) return finish_first_guess(h);
  contacts.take_contacts();
  std::swap(x, trial);
  energy = moved_energy;
}

// Whether the guess came as was foreseen, once the device was waited for.
bool Simulation::Impl::first_guess_holds() {
  if (!std::exchange(is_guess_foreseen, false)) return true;
  const bool served = contacts.take_foreseen();
  lacking_at_guess = contacts.lacked_candidates();
  return served && potential.take_foreseen(contacts, coupled_worlds());
}

void Simulation::Impl::repeat_first_guess(double h) {
  ++counts.repeated_guesses;
  std::swap(x, before_guess);
  dx.write(guessed_motion);
  potential.set_friction(contacts);  // no direction was found with it
  {
    const auto timed = clock.time(SolverPhase::broad_phase);
    write_active(is_intact);
    move(full_step);
    contacts.find_candidates(x.site, trial.site);
  }
  finish_first_guess(h);
}

// Robots whose joints follow their drives are moved as these lead.
void Simulation::Impl::follow_drives(std::span<const char> goes_on, double h, std::vector<double>& motion) const {
  std::vector<double> by_velocity;
  for (std::size_t w = 0; w < goes_on.size(); ++w) {
    if (!is_intact[w] || !goes_on[w]) continue;
    const auto changes = foreseen_changes(system, w, carried[w], joint_motion[w], states[w].joint_position,
                                          target_change[w], contacts.lagged().on_host());
    if (!changes) continue;
    if (by_velocity.empty()) by_velocity = extrapolated_motion(system, nodes, velocities, h);
    pvg::follow_drives(system, w, *changes, contacts.lagged().on_host(), nodes, by_velocity, motion);
  }
}

void Simulation::Impl::take_expected(std::vector<double>& motion) const {
  for (std::size_t w = 0; w < expected.size(); ++w)
    std::copy(expected[w].begin(), expected[w].end(), motion.begin() + 3 * std::ptrdiff_t(system.node_ranges[w].begin));
}

void Simulation::Impl::prescribe(double h) {
  if (!has_prescribed) return;
  prescribed.resize(system.x.size());
  for (std::size_t w = 0; w < system.n_worlds(); ++w) write_prescribed(system, w, states[w].time + h, prescribed);
  std::vector<double> values;
  for_each_prescribed([&](u32 first) { values.insert(values.end(), &prescribed[first], &prescribed[first] + 12); });
  prescribed_values.write(values);
  const u32 n = u32(prescribed_nodes.size());
  place_nodes(n, n, prescribed_nodes, prescribed_values, predicted.node);
  potential.update_sites(predicted);
}

void Simulation::Impl::aim_prescribed(std::vector<double>& motion) {
  for_each_prescribed([&](u32 first) {
    for (u32 i = first; i < first + 12; ++i) motion[i] = prescribed[i] - nodes[i];
  });
}

}  // namespace pvg
