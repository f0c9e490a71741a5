// Disturbances that a run states: forces and torques on rigid bodies that are known. They act in the simulation of that
// run alone, as the effect `push`, which is no candidate.
#pragma once
#include <string>
#include <vector>

#include "host/load/recording/recording.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg::diagnose {

// A force or torque from one time of the run's clock to another; `effect` is a push without its times.
struct KnownPush {
  double from = 0, to = 0;  // [s]
  Effect effect;
};

// Columns hold their mean between two rows, on the line over rows without a number. place: of the list in the file, for
// messages. Throws a UsageError that names the entry and what to do.
std::vector<KnownPush> known_pushes(const PhysicalScene& scene, const RecordedRun& run, const std::string& place);

// Adds those that act in a window of the run to the scene of its world. start, end: of the run's clock [s]
void add_pushes(const std::vector<KnownPush>& pushes, double start, double end, PhysicalScene& scene);

}  // namespace pvg::diagnose
