// A window as a world of the simulator: where its bodies start, what its drives are told, and what they still obey of
// what they were told before.
#pragma once
#include <vector>

#include "host/identify/data/window.hpp"

namespace pvg::diagnose {

// `scene`, a variant of the problem's, with the bodies where `initial` says and those that are prescribed on the paths
// of the window's run.
Scene world_of(const Problem& problem, const Scene& scene, const Window& window, const InitialState& initial);

// What the drives are told in the step of length h that ends at `time` of the run's clock. A torque acts over the
// whole step, so its value in the middle stands for it.  [n_driven]
std::vector<double> targets_of(const Scene& scene, const Run& run, double time, double h);

// Of drives that follow late: what they obey at `time`, and what they were told before, the last step's first.
struct DriveMemory {
  std::vector<double> command, past;  // as a Checkpoint has them
};
DriveMemory memory_of(const Scene& scene, const Run& run, double time, double h);

}  // namespace pvg::diagnose
