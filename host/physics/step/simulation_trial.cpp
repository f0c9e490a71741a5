// Trials of a step of Newton's method: along its direction as far as no contact is in the way, halved until the energy
// does not rise.
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/physics/step/simulation_impl.hpp"

namespace pvg {
namespace {

constexpr int MAX_LINE_SEARCH = 40;  // lengths of one Newton step that are tried
constexpr int MOST_AHEAD = 8;        // halvings of a step are started before the host looks
constexpr double ROUNDING = 1e-12;   // of an energy

bool any_rises(const std::vector<char>& rises) { return std::find(rises.begin(), rises.end(), true) != rises.end(); }

}  // namespace

// trial = x + length dx, per world
void Simulation::Impl::move(const Buffer<f64>& length) {
  const u32 n_nodes = u32(system.n_nodes()), n_sites = u32(system.sites.size()), n = std::max(n_nodes, n_sites);
  move_along(n, n, n_nodes, n_sites, node_world, potential.sites(), length, x.node, dx, trial.node, trial.site);
}

void Simulation::Impl::move(const std::vector<double>& length) {
  step.write(length);
  move(step);
}

void Simulation::Impl::write_active(const std::vector<char>& worlds) {
  if (worlds == active_written) return;
  active_written = worlds;
  is_active_on_device.write(std::vector<u32>(worlds.begin(), worlds.end()));
  full_step.write(std::vector<double>(worlds.begin(), worlds.end()));
}

void Simulation::Impl::start_move(const std::vector<char>& worlds) {
  write_active(worlds);
  move(full_step);
  start_check();
}

// Elsewhere than on the host's own processor the move is certified next, without a look between the two.
void Simulation::Impl::start_check() {
  if (device.info().runs_host_functions)
    contacts.start_check(x.site, trial.site);
  else
    contacts.defer_check();
}

// The same, with how far points would move.
void Simulation::Impl::start_look_ahead() {
  if (speed_chunks.has_large_world()) {
    reduce.largest_length(speed_chunks, potential.sites(), dx, largest);
    start_move(is_active);
  } else {
    write_active(is_active);
    const u32 n_nodes = u32(system.n_nodes()), n_sites = u32(system.sites.size()), n_worlds = u32(system.n_worlds());
    const u32 n = u32(GROUP_SIZE) * n_worlds + std::max(n_nodes, n_sites);
    measure_and_move(n, n, n_worlds, n_nodes, n_sites, speed_chunks.first(), speed_chunks.chunks(), node_world,
                     potential.sites(), full_step, x.node, dx, largest, trial.node, trial.site);
    start_check();
  }
  largest.read_later(0, std::span(largest_move));
}

void Simulation::Impl::start_certified_move(bool settles, double h, double short_of, int halvings) {
  const Buffer<f64>& free_parts = contacts.start_largest_steps(x.site, trial.site);
  const u32 n_nodes = u32(system.n_nodes()), n_sites = u32(system.sites.size()), n = std::max(n_nodes, n_sites);
  move_certified(n, n, n_nodes, n_sites, node_world, potential.sites(), contacts.first_candidate(), free_parts,
                 contacts.least_of_64_steps(), is_active_on_device, u32(settles), largest, tolerance, h, short_of,
                 x.node, dx, trial.node, trial.site, step);
  start_trial_energy(halvings == 0);
  if (halvings > 0) {
    step.read_later(0, std::span(longest));
    start_halvings(halvings);
  }
  start_read_trial();
}

// The certified move of an iteration of Newton's method, and what the host keeps of the step if it ends there, as it is
// foreseen to do after as many iterations as the last one took; else that is read when the step has ended.
void Simulation::Impl::start_trial(bool settles, double h) {
  start_certified_move(settles, h, 1, n_halvings);
  if (n_directions != n_directions_before) return;
  start_read_end(trial);
  read_end_of_trial = true;
}

// What the host keeps of a step that ends at these positions.
void Simulation::Impl::start_read_end(const Positions& end) {
  end.node.read_later(0, std::span(nodes));
  contacts.lagged().start_anchors(end.site, start.site, length);
}

void Simulation::Impl::start_trial_energy(bool is_last) {
  trial_energy = &potential.start_energy(trial, contacts, is_last);
}

// How far trial is from x, its contacts and its energy, once the device was waited for.
void Simulation::Impl::start_read_trial() {
  read_end_of_trial = false;
  potential.start_list_contacts(contacts);
  step.read_later(0, std::span(certified));
  trial_energy->read_later(0, std::span(moved_energy));
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

// Moves to trial = x + length dx and finds its contacts and its energy per world [J].
void Simulation::Impl::evaluate(const std::vector<double>& length) {
  move(length);
  start_trial_energy(true);
  start_read_trial();
  device.finish();
  contacts.take_contacts();
}

// Worlds whose energy is more at trial than it was [J]; a rise within rounding counts as none.
std::vector<char> Simulation::Impl::rising_worlds(const std::vector<double>& before) const {
  std::vector<char> rises;
  for (std::size_t w = 0; w < before.size(); ++w)
    rises.push_back(is_active[w] && !(moved_energy[w] <= before[w] + ROUNDING * std::abs(before[w])));
  return rises;
}

// Of a first guess that the host does not know yet the device has it.
void Simulation::Impl::keep_energy_before() {
  if (is_guess_foreseen)
    energy_before.copy_from(*trial_energy);
  else
    energy_before.write(energy);
}

// Halves the steps of worlds whose energy rose, so often, and finds their energies each time on the device.
void Simulation::Impl::start_halvings(int times) {
  const u32 n_worlds = u32(system.n_worlds()), n_nodes = u32(system.n_nodes()), n_sites = u32(system.sites.size());
  const u32 n = std::max({n_worlds, n_nodes, n_sites});
  for (int i = 0; i < times; ++i) {
    halve_and_move(n, n, n_nodes, n_sites, n_worlds, node_world, potential.sites(), is_active_on_device, energy_before,
                   *trial_energy, ROUNDING, step, x.node, dx, halved_step, trial.node, trial.site);
    std::swap(step, halved_step);
    start_trial_energy(i + 1 == times);
  }
}

// How often the steps of a line search were halved, at most.
int Simulation::Impl::halvings_taken() const {
  int most = 0;
  for (std::size_t w = 0; w < longest.size(); ++w)
    if (certified[w] > 0) most = std::max(most, std::ilogb(longest[w]) - std::ilogb(certified[w]));
  return most;
}

// Halves each world's step until its energy does not rise. Contact was certified by the whole step, so no pair touches.
void Simulation::Impl::line_search(bool foreseen) {
  const auto timed = clock.time(SolverPhase::line_search);
  if (!foreseen) evaluate(certified);
  int n_tried = foreseen ? n_halvings : 0;  // as were started ahead
  if (n_tried == 0) longest = certified;
  std::vector<char> rises = rising_worlds(energy);
  if (any_rises(rises)) {
    keep_energy_before();
    write_active(is_active);
  }
  for (; any_rises(rises); rises = rising_worlds(energy)) {
    if (n_tried >= MAX_LINE_SEARCH - 1) {
      std::vector<double> length = certified;
      for (std::size_t w = 0; w < rises.size(); ++w) {
        if (!rises[w]) continue;
        give_up(w, StepEvent::Kind::exhausted_line_search, fastest_node(w),
                "no decrease of the energy was found along it");
        length[w] = 0;
      }
      evaluate(length);
      break;
    }
    // elsewhere than on the host's own processor a look takes as long as two launches, and one halving takes four
    const int wanted = device.info().runs_host_functions ? 1 : n_tried == 0 ? 2 : 3;
    const int times = std::min(wanted, MAX_LINE_SEARCH - 1 - n_tried);
    start_halvings(times);
    start_read_trial();
    device.finish();
    contacts.take_contacts();
    n_tried += times;
  }
  halvings.push_back(std::min(halvings_taken(), MOST_AHEAD));
  energy = moved_energy;
  std::swap(x, trial);
  has_read_end = read_end_of_trial;
}

}  // namespace pvg
