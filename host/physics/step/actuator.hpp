// What becomes of the targets that drives are given: delayed, then followed with a lag,
//   delayed(t) = given(t - delay), straight between steps;   command' = (delayed - command) / T,
// which over a step of length h, in which `delayed` goes straight from d0 to d1, has the solution
//   command1 = d1 - b + (command0 - d0 + b) exp(-h / T),   b = (d1 - d0) T / h
#pragma once
#include <vector>

#include "host/model/physical_scene.hpp"

namespace pvg {

// One world's drives. Its past is a plain list, so that a checkpoint can hold it.
class Actuators {
 public:
  Actuators(const PhysicalScene& scene, std::vector<double> start);  // start: of each driven joint

  // What the drives obey in a step that ends with these targets.  [n_driven, rad or m]
  std::vector<double> command(const std::vector<double>& targets, const std::vector<double>& last_command) const;
  void accept(const std::vector<double>& targets);  // the step was done

  std::vector<double> past() const { return past_; }
  bool restore(const std::vector<double>& past);  // false: it is not of this scene

 private:
  double delayed(std::size_t drive, double target, std::size_t steps_ago) const;
  std::size_t n_past_ = 0;  // targets kept of each drive
  double h_;                // [s]
  std::vector<double> delay_, time_constant_, start_;
  std::vector<double> past_;  // [n_past][n_driven] targets given, the last step's first
};

}  // namespace pvg
