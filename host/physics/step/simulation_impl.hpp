// What a simulation keeps. Its work is in files: simulation.cpp (set-up and interface), simulation_step.cpp (one step:
// Newton's method on the incremental potential), simulation_guess.cpp (where it starts), simulation_trial.cpp (how far
// it goes), simulation_events.cpp (what goes wrong) and simulation_state.cpp (what goes in and what is read out).
#pragma once
#include <algorithm>
#include <optional>
#include <utility>

#include "host/physics/energies/joint.hpp"
#include "host/physics/linear/conjugate_gradients.hpp"
#include "host/physics/step/actuator.hpp"
#include "host/physics/step/joint_motion.hpp"
#include "host/physics/step/phase_clock.hpp"
#include "host/physics/step/potential.hpp"
#include "host/physics/step/restitution.hpp"
#include "host/physics/step/simulation.hpp"
#include "host/physics/step/time_integration.hpp"

namespace pvg {

template <class Flags>
bool any(const Flags& flags) {
  return std::any_of(flags.begin(), flags.end(), [](bool is_set) { return is_set; });
}

struct Simulation::Impl {
  Impl(Device& device, std::span<const PhysicalScene> worlds);

  // One step of length h of these worlds toward `targets`, from `previous` targets. Those that are not well after it
  // have x and v as they were before. goes_on: of all of them, as the integrator says.
  void advance(double h, const std::vector<std::vector<double>>& previous,
               const std::vector<std::vector<double>>& targets, const std::vector<char>& worlds, bool goes_on);
  // The same, halving where it fails, each such world by itself. Returns which worlds failed for good.
  std::vector<char> advance_or_halve(double h, const std::vector<std::vector<double>>& previous,
                                     const std::vector<std::vector<double>>& targets, const std::vector<char>& worlds,
                                     int halvings_left);

  // simulation_events.cpp: ends the attempt of one world and puts it back to where it began
  void give_up(std::size_t world, StepEvent::Kind kind, u32 node, const std::string& detail);
  void give_up(StepEvent event);
  void give_up_inverted();
  std::optional<u32> first_not_finite(const std::vector<double>& values, std::size_t world) const;  // node
  std::optional<u32> first_not_finite(const Buffer<f64>& values, std::size_t world) const;          // [n_nodes x 3]
  u32 fastest_node(std::size_t world) const;                                                        // by dx

  void refuse_start_conflicts();
  void set_joints(double h, const std::vector<std::vector<double>>& previous,
                  const std::vector<std::vector<double>>& targets);
  void push(double h, bool goes_on);                 // what pushes do in this step, into the rows of point_force
  void prescribe(double h);                          // where prescribed bodies are to be, into `predicted`
  void aim_prescribed(std::vector<double>& motion);  // of prescribed nodes: all the way there
  template <class Found>
  void for_each_prescribed(const Found& found) const {  // its first number among those of the nodes, of 12
    for (std::size_t w = 0; has_prescribed && w < system.n_worlds(); ++w)
      for (std::size_t b = 0; b < system.scenes[w].rigid_bodies.size(); ++b)
        if (system.scenes[w].rigid_bodies[b].is_prescribed) found(3 * system.rigid_first_node[w][b]);
  }
  // simulation_guess.cpp: x from the start of the step to where the velocities lead; elsewhere than on the host's own
  // processor without waiting for it
  void move_to_first_guess(double h);
  std::vector<double> first_motion(double h);  // [n_nodes x 3, m]
  void start_first_guess(double h);
  void finish_first_guess(double h);
  bool first_guess_holds();
  void repeat_first_guess(double h);
  void follow_drives(std::span<const char> goes_on, double h, std::vector<double>& motion) const;
  void take_expected(std::vector<double>& motion) const;  // [n_nodes x 3] of worlds of which a motion is expected
  void move(const std::vector<double>& length);           // trial = x + length dx, per world
  void move(const Buffer<f64>& length);
  void write_active(const std::vector<char>& worlds);
  // Starts to move along dx, of these worlds, and to find whether the candidates serve for it.
  void start_move(const std::vector<char>& worlds);
  void start_check();
  // From there, starts to move as far as no contact is in the way: certified, trial, its contacts and energy. settles,
  // h, short_of: as of solve/newton.cl; halvings: of steps that rise above energy_before
  void start_certified_move(bool settles, double h, double short_of, int halvings = 0);
  void find_minimum(double h);
  // is_started: read_contacts() did, at x
  void lag_friction(double h, const Positions& foreseen, bool is_started);
  void minimize(double h, bool may_be_settled, double enough);
  std::vector<double> certify();
  bool has_contact(std::size_t world) const;
  std::vector<char> wanted_matrices();
  void start_solve();
  std::optional<CgReport> solve_direction(double h, bool settles);
  std::optional<CgReport> factorize_and_solve(double h, bool settles);
  void start_look_ahead();
  void couple_contacts(const CgReport& report);
  void renew_couplings(Potential::Coupling when);
  std::vector<char> coupled_worlds() const;  // whose factors hold contacts
  // dx, the largest speed of a point per world, times h [m], and the move along it. False where that is to be done
  // again: a world was given up.
  bool find_direction(double h, bool settles);
  // foreseen: `moved_energy` holds what the whole certified step leads to
  void line_search(bool foreseen);
  void start_trial(bool settles, double h);
  void start_read_end(const Positions& end);
  void start_trial_energy(bool is_last);  // of this trial; start_read_trial() comes next
  void start_read_trial();
  void evaluate(const std::vector<double>& length);
  std::vector<char> rising_worlds(const std::vector<double>& before) const;
  void keep_energy_before();  // that at x
  void start_halvings(int times);
  int halvings_taken() const;
  void read_state(double h);
  void read_contacts(double h);
  void read_joints(double h);
  void restitute();  // velocities of bodies that have met at the end of this attempt
  void read_pressing();
  void read_displays(std::size_t world, double h);

  double h() const { return system.scenes[0].solver.time_step; }
  const SolverSettings& solver() const { return system.scenes[0].solver; }

  Device& device;
  PhaseClock clock;
  SolverCounts counts;                 // without the phases', which the clock keeps
  DeviceCounts counted_from;           // of the device, where `counts` begins
  std::vector<PhysicalScene> nominal;  // [n_worlds] as given, without effects: what drives know of what they carry
  System system;
  Potential potential;
  Program nodes_program, newton_program;
  Kernel move_along, place_nodes, halve_and_move, move_certified, measure_and_move;
  Buffer<u32> node_world, is_active_on_device, prescribed_nodes;
  std::vector<char> active_written;             // what is_active_on_device and full_step hold
  Buffer<f64> dx, gradient, step, halved_step;  // step: of each world, and what comes next
  Buffer<f64> full_step, largest, tolerance;    // full_step: 1 for worlds that move; tolerance [m/s]
  std::vector<double> least_stop;               // [n_worlds] newton_tolerance [m/s]
  Buffer<f64> energy_before;                    // [n_worlds, J] of a line search
  const Buffer<f64>* trial_energy = nullptr;    // [n_worlds, J] of the last trial
  TimeIntegrator integrator;
  Positions x, start, predicted, trial, before_guess;
  ContactSet contacts;
  ConjugateGradients cg;
  WorldReduce reduce;
  WorldChunks speed_chunks;
  std::vector<double> largest_move, moved_energy;  // [n_worlds] of the last move, as read
  std::vector<double> longest, certified;          // and its steps before they were halved, and after
  int n_halvings = 0;                              // that are started before the host looks
  std::vector<int> halvings, halvings_before;      // of each direction of this attempt, and of the one before
  std::vector<int> solves, solves_before;          // likewise iterations of conjugate gradients
  std::vector<double> nodes, velocities;           // [n_nodes x 3] at the start of the step, nodes as last read
  std::vector<double> velocities_before, velocities_two_before;  // and of the two before it
  std::vector<double> start_nodes, nodes_before;                 // at the start of this step, of the one before
  std::vector<std::vector<double>> expected;                     // [n_worlds][n_nodes of it x 3] empty: no motion is
  std::vector<double> prescribed;                                // [n_nodes x 3] where prescribed bodies are to be
  Buffer<f64> prescribed_values;                                 // the same of prescribed_nodes [n x 3]
  bool knows_motion = false;                                     // nodes and velocities are those of the device

  std::vector<std::vector<Carried>> carried;                  // [n_worlds][n_joints]
  std::vector<std::vector<std::vector<double>>> soft_masses;  // [n_worlds][n_soft][n_nodes, kg]
  std::vector<std::vector<StepDrive>> drives;                 // [n_worlds][n_joints], of this step
  std::vector<double> pressing;                               // [n_rolling_resistances] last normal force [N]
  std::vector<std::vector<JointMotion>> joint_motion;         // [n_worlds][n_joints]
  std::vector<std::vector<double>> target_change;             // [n_worlds][n_joints] of drives of position, this step
  std::vector<std::vector<RestitutionPair>> restitution;      // [n_worlds]
  std::vector<Actuators> actuators;                           // [n_worlds]
  std::vector<std::vector<double>> last_targets;              // that the drives obeyed
  std::vector<char> is_retired;                               // worlds that take no further steps
  std::vector<char> is_intact;                                // worlds of this attempt that have not failed
  double length = 0, inertia_length = 0;                      // of this attempt [s]
  std::vector<char> is_unsettled;                             // of these, worlds whose lagged friction still changes
  std::vector<char> is_active;                                // of these, worlds that Newton's method still moves
  std::vector<WorldState> states;
  std::vector<StepReport> reports;
  // [n_worlds] whose matrix this iteration keeps, and the next one may; how fast the last correction is [m/s]
  std::vector<char> keeps_matrix, may_keep_matrix;
  std::vector<double> last_speed;
  bool begins_step = true;                                  // no direction was found yet
  bool has_begun_solve = false;                             // dx and the residual are those that a solve starts from
  int n_directions = 0, n_directions_before = 0;            // that were found in this attempt, and in the one before
  bool read_end_of_trial = false, has_read_end = false;     // start_read_end() was for trial; for x, and waited for
  Candidates::Lists lacking_at_guess = {true, true, true};  // candidates that did not serve the last first guess
  bool is_guess_foreseen = false;                           // x is a first guess that the host does not know yet
  std::vector<double> guessed_motion;                       // [n_nodes x 3] to the first guess
  std::vector<double> energy;                               // at x, per world [J]
  bool has_prescribed;                                      // bodies
};

}  // namespace pvg
