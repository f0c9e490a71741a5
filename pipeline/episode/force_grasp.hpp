// Closing until the fingers bear a force: the targets of the gripper's joints follow the plan until the drives exert
// what was asked for, come to rest, and stay there until the gripper opens again. Everything before and after is the
// plan's.
#pragma once
#include <optional>
#include <vector>

#include "host/physics/step/simulation.hpp"
#include "pipeline/episode/motion_plan.hpp"

namespace pvg {

class ForceGrasp {
 public:
  explicit ForceGrasp(const MotionPlan& plan);
  // The target of the step, from the plan and from the state at the step's start.  [n_driven, rad or m]
  std::vector<double> target(std::size_t step, const WorldState& state);

 private:
  struct Gripper {
    double position = 0;       // target of the last step [m]
    double velocity = 0;       // of it, per step [m]
    double start = 0;          // where the grip under way began [m]
    bool has_stopped = false;  // the force was reached
  };
  const MotionPlan& plan_;
  std::vector<Gripper> grippers_;
};

}  // namespace pvg
