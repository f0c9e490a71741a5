// Time integration as a prediction and a difference: with past positions x* and velocities v*,
//   x~ = x* + h' v* + h'^2 g,   E_inertia = |x - x~|^2_M / (2 h'^2),   v = (x - x*) / h'
// implicit Euler:  x* = x_n,  v* = v_n,  h' = h
// BDF2:            x* = (4 x_n - x_{n-1}) / 3,  v* = (4 v_n - v_{n-1}) / 3,  h' = 2 h / 3   (Curtiss & Hirschfelder
// 1952) BDF2 needs a step of the same length before it: the first one, and those after a change of length, are implicit
// Euler.
#pragma once
#include <span>
#include <vector>

#include "host/model/checkpoint.hpp"
#include "host/physics/energies/system.hpp"
#include "solve/site.h"

namespace pvg {

struct Positions;

class TimeIntegrator {
 public:
  TimeIntegrator(Device& device, const System& system);

  // Has the world had a step of this length just before?
  bool goes_on(std::size_t world, double h) const { return length_before_[world] == h; }
  // start: x, which accept() gets again;  predicted: where inertia and gravity lead from there in a step of length h
  // [s]; both with sites. Returns h'. goes_on: of all worlds that step
  double begin_step(const Buffer<f64>& x, double h, SolverSettings::Integrator integrator, bool goes_on,
                    const Buffer<Site>& sites, Positions& start, Positions& predicted);
  // After the step of the worlds for which `stepped`: their new velocities, from the positions at its start and end.
  void accept(const Buffer<f64>& start, const Buffer<f64>& end, std::span<const char> stepped);
  // The same velocities found by the host, to the bit, so that they need not travel [n_nodes x 3, m/s]. before: the
  // positions at the start of the step before this one [n_nodes x 3, m]
  std::vector<double> velocities(std::span<const double> before, std::span<const double> start,
                                 std::span<const double> end) const;

  const Buffer<f64>& velocity() const { return velocity_; }                        // [n_nodes x 3, m/s]
  const Buffer<f64>& position_before() const { return position_before_; }          // at the start of the last step
  const Buffer<f64>& velocity_before() const { return velocity_before_; }          // likewise
  const Buffer<f64>& velocity_two_before() const { return velocity_two_before_; }  // and of the one before
  // What an impact made of the velocities of nodes from `first_node` on [3 n, m/s]: without a past that BDF2 goes on
  // by.
  void change_velocity(std::size_t world, std::size_t first_node, std::span<const double> velocity,
                       SolverSettings::Integrator integrator);
  MotionHistory history() const;
  void restore(const MotionHistory& history);

 private:
  u32 n_;
  Program program_;
  Kernel begin_step_, backward_difference_, end_step_;
  Buffer<u32> node_is_fixed_;
  Buffer<f64> gravity_, velocity_, position_before_, velocity_before_, velocity_two_before_, past_position_,
      past_velocity_;
  std::vector<WorldRange> node_ranges_;
  std::vector<double> length_before_;       // [n_worlds, s]
  double length_ = 0, inertia_length_ = 0;  // [s]
  bool is_second_order_ = false;            // the last prediction
};

}  // namespace pvg
