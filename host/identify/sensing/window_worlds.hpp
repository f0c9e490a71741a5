// Windows as worlds of one solve that are stepped through their commands.
#pragma once
#include <vector>

#include "host/identify/data/window.hpp"
#include "host/physics/step/simulation.hpp"

namespace pvg::diagnose {

class WindowWorlds {
 public:
  // scenes, windows: of each world, the scenes as they start. Throws a UsageError where a start cannot be.
  WindowWorlds(Device& device, const Problem& problem, std::vector<PhysicalScene> scenes,
               std::vector<const Window*> windows);
  const PhysicalScene& scene(std::size_t world) const { return scenes_[world]; }
  Simulation& simulation() { return simulation_; }
  // The step of this number, from 1 on, toward the commands at its end. Throws a StepFailure as a simulation does.
  void step(std::size_t number);

 private:
  const Problem& problem_;
  std::vector<PhysicalScene> scenes_;
  std::vector<const Window*> windows_;
  Simulation simulation_;
  double h_;
};

}  // namespace pvg::diagnose
