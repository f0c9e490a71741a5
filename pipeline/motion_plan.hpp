// The reference of every step of an episode: the robot's motion, in the order and number that the simulation asks for.
#pragma once
#include <string>
#include <vector>

#include "host/scene/build_scene.hpp"
#include "host/scene/task.hpp"

namespace pvg {

struct MotionPlan {
  std::vector<std::vector<double>> targets;  // [n_steps][n_driven, rad or m] the joints with a drive, as Scene::joints
  std::vector<int> element;                  // [n_steps] of Task::motion
  std::size_t steps_per_frame = 1;           // n_steps is a multiple of it
};

// Throws a UsageError where a target is out of reach.
MotionPlan plan_episode(const Task& task, const TaskScene& built);

// Steps between two frames; a UsageError where frames do not fall on steps.
std::size_t steps_per_frame(double frames_per_second, double time_step);

std::string element_name(const MotionElement& element);

}  // namespace pvg
