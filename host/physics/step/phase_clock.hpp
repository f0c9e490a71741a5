// Where a step's time goes, and what it asks of the device. Times are off unless asked for: every phase then ends with
// waiting for the device.
#pragma once
#include <array>
#include <chrono>

#include "host/device/device.hpp"

namespace pvg {

enum class SolverPhase {
  broad_phase,
  narrow_phase,
  assembly,
  preconditioner,
  solve,
  continuous_collision,
  line_search
};
constexpr std::size_t N_PHASES = 7;
constexpr std::array<const char*, N_PHASES> PHASE_NAMES = {
    "broad_phase", "narrow_phase", "assembly", "preconditioner", "solve", "continuous_collision", "line_search"};

using PhaseSeconds = std::array<double, N_PHASES>;  // [s]

struct SolverCounts {
  DeviceCounts all, recording;                // recording: reading the state at the end of a step
  std::array<DeviceCounts, N_PHASES> phases;  // of `all`
  std::size_t newton = 0, cg = 0;             // iterations of all worlds together: as often as any world has one
  std::size_t repeated_guesses = 0;           // first guesses that did not come as they were foreseen
};

class PhaseClock {
 public:
  explicit PhaseClock(Device& device) : device_(device) {}

  // Counts from its making to its end.
  class Scope {
   public:
    Scope(PhaseClock& clock, SolverPhase phase) : clock_(clock), phase_(phase) {
      if (clock_.is_on) clock_.device_.finish();
      start_ = std::chrono::steady_clock::now();
      before_ = clock_.device_.counts();
    }
    ~Scope() {
      clock_.counts[std::size_t(phase_)] += clock_.device_.counts() - before_;
      if (!clock_.is_on) return;
      clock_.device_.finish();
      clock_.seconds[std::size_t(phase_)] +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }
    Scope(const Scope&) = delete;

   private:
    PhaseClock& clock_;
    SolverPhase phase_;
    std::chrono::steady_clock::time_point start_;
    DeviceCounts before_;
  };
  Scope time(SolverPhase phase) { return Scope(*this, phase); }

  bool is_on = false;
  PhaseSeconds seconds{};                     // since it was switched on
  std::array<DeviceCounts, N_PHASES> counts;  // as far as phases are told apart

 private:
  Device& device_;
};

}  // namespace pvg
