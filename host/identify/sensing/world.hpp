// A window as a world of the simulator: where its bodies start, the commands of its drives, and earlier commands that
// they still follow.
#pragma once
#include <vector>

#include "host/identify/data/window.hpp"

namespace pvg::diagnose {

// `scene`, a variant of the problem's, with the bodies where `initial` says and those that are prescribed on the paths
// of the window's run.
PhysicalScene world_of(const Problem& problem, const PhysicalScene& scene, const Window& window,
                       const InitialState& initial);

// The drives' commands in the step of length h that ends at `time` of the run's clock. Of a torque, implicit Euler is
// given its value in the middle of the step, BDF2 that of the end.  [n_driven]
std::vector<double> targets_of(const PhysicalScene& scene, const Run& run, double time, double h);

// Of drives that follow late: the command at `time`, and those before, the last step's first.
struct DriveMemory {
  std::vector<double> command, past;  // as a Checkpoint has them
};
DriveMemory memory_of(const PhysicalScene& scene, const Run& run, double time, double h);

std::size_t n_nodes(const PhysicalScene& scene);

// Whether it has so many nodes that a simulation takes seconds of a processor.
bool is_large(const PhysicalScene& scene);

}  // namespace pvg::diagnose
