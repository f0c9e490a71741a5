// What a simulation keeps. Its work is in three files: simulation.cpp (set-up and interface), simulation_step.cpp (one
// step: Newton's method on the incremental potential) and simulation_state.cpp (what goes in and what is read out).
#pragma once
#include <optional>
#include <utility>

#include "host/physics/energies/joint.hpp"
#include "host/physics/linear/conjugate_gradients.hpp"
#include "host/physics/step/actuator.hpp"
#include "host/physics/step/phase_clock.hpp"
#include "host/physics/step/potential.hpp"
#include "host/physics/step/simulation.hpp"
#include "host/physics/step/time_integration.hpp"

namespace pvg {

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
  std::optional<u32> first_not_finite(const Buffer<f64>& values, std::size_t world) const;  // node; [n_nodes x 3]
  u32 fastest_node(std::size_t world) const;                                                // by dx

  void refuse_start_conflicts();
  void set_joints(double h, const std::vector<std::vector<double>>& previous,
                  const std::vector<std::vector<double>>& targets);
  void prescribe(double h);                          // where prescribed bodies are to be, into `predicted`
  void aim_prescribed(std::vector<double>& motion);  // of prescribed nodes: all the way there
  void move_to_first_guess(double h);
  void move(const std::vector<double>& length);  // trial = x + length dx, per world
  void find_minimum(double h);
  void lag_friction(double h, const Positions& foreseen);
  void minimize(double h, bool may_be_settled, double enough);
  std::vector<double> certify();
  void find_contacts();
  void factorize();
  CgReport solve();
  void couple_contacts(const CgReport& report);
  void renew_couplings(Potential::Coupling when);
  std::vector<double> find_direction();  // dx, and the largest speed of a point per world, times h [m]
  void line_search(const std::vector<double>& certified);
  std::vector<double> energy_at(const std::vector<double>& length);
  void read_state(double h);
  void read_joints(double h);
  void read_pressing();
  void read_displays(std::size_t world, double h);

  double h() const { return system.scenes[0].solver.time_step; }
  const SolverSettings& solver() const { return system.scenes[0].solver; }

  Device& device;
  PhaseClock clock;
  std::vector<PhysicalScene> nominal;  // [n_worlds] as given, without effects: what drives know of what they carry
  System system;
  Potential potential;
  Program nodes_program;
  Kernel move_along;
  Buffer<u32> node_world;
  Buffer<f64> dx, gradient, step, largest;
  TimeIntegrator integrator;
  Positions x, start, predicted, trial;
  ContactSet contacts;
  ConjugateGradients cg;
  WorldReduce reduce;
  WorldChunks speed_chunks;
  Positions direction;

  std::vector<std::vector<Carried>> carried;                  // [n_worlds][n_joints]
  std::vector<std::vector<std::vector<double>>> soft_masses;  // [n_worlds][n_soft][n_nodes, kg]
  std::vector<std::vector<StepDrive>> drives;                 // [n_worlds][n_joints], of this step
  std::vector<double> pressing;                               // [n_rolling_resistances] last normal force [N]
  std::vector<Actuators> actuators;                           // [n_worlds]
  std::vector<std::vector<double>> last_targets;              // that the drives obeyed
  std::vector<char> is_retired;                               // worlds that take no further steps
  std::vector<char> is_intact;                                // worlds of this attempt that have not failed
  double length = 0;                                          // of this attempt [s]
  std::vector<char> is_unsettled;                             // of these, worlds whose lagged friction still changes
  std::vector<char> is_active;                                // of these, worlds that Newton's method still moves
  std::vector<WorldState> states;
  std::vector<StepReport> reports;
  bool begins_step = true;     // no direction was found yet
  std::vector<double> energy;  // at x, per world [J]
  bool has_prescribed;         // bodies
};

}  // namespace pvg
