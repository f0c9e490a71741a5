#include "host/identify/sensing/window_worlds.hpp"

#include "host/identify/sensing/world.hpp"

namespace pvg::diagnose {

WindowWorlds::WindowWorlds(Device& device, const Problem& problem, std::vector<PhysicalScene> scenes,
                           std::vector<const Window*> windows)
    : problem_(problem),
      scenes_(std::move(scenes)),
      windows_(std::move(windows)),
      simulation_(device, scenes_),
      h_(scenes_.front().solver.time_step) {
  Checkpoint begin = simulation_.checkpoint();
  for (std::size_t w = 0; w < scenes_.size(); ++w) {  // so that no drive sees its reference jump in the first step
    const Window& window = *windows_[w];
    DriveMemory memory = memory_of(scenes_[w], problem.runs[std::size_t(window.run)], window.start, h_);
    begin.targets[w] = std::move(memory.command);
    begin.past_targets[w] = std::move(memory.past);
  }
  simulation_.restore(begin);
}

void WindowWorlds::step(std::size_t number) {
  std::vector<std::vector<double>> targets;
  for (std::size_t w = 0; w < scenes_.size(); ++w) {
    const Run& run = problem_.runs[std::size_t(windows_[w]->run)];
    targets.push_back(targets_of(scenes_[w], run, windows_[w]->start + double(number) * h_, h_));
  }
  simulation_.step(targets);
}

}  // namespace pvg::diagnose
