// The reference of every step of an episode: the robot's motion, in the order and number that the simulation asks for.
#pragma once
#include <string>
#include <vector>

#include "host/load/build_scene.hpp"
#include "host/model/task.hpp"

namespace pvg {

// Steps [first, last) in which a robot's gripper opens or closes, in the plan from one position to another.
struct Grip {
  int robot = 0;
  std::size_t first = 0, last = 0;
  double from = 0, to = 0;  // [m]
  double force = 0;         // at which closing ends [N]; 0: it does not
};

struct MotionPlan {
  std::vector<std::vector<double>> targets;  // [n_steps][n_driven, rad or m] the joints with a drive, as Scene::joints;
                                             // they lead the planned path where a robot feeds friction forward
  std::vector<std::vector<double>> disturbance;  // [n_steps][n_driven] what pushes the drives' targets away from
                                                 // `targets`, which stay what is wanted; empty: nothing does
  std::vector<int> element;                      // [n_steps] of Task::motion
  std::size_t steps_per_frame = 1;               // n_steps is a multiple of it
  std::vector<Grip> grips;                       // in their order
  std::vector<std::vector<int>> gripper_columns, gripper_joints;  // [n_robots] of targets; of Scene::joints
};

// Throws a UsageError where a target is out of reach, or deep inside of a fixed body.
MotionPlan plan_episode(const Task& task, const TaskScene& built);

// Steps between two frames; a UsageError where frames do not fall on steps.
std::size_t steps_per_frame(double frames_per_second, double time_step);

}  // namespace pvg
