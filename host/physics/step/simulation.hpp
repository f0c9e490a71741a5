// The simulator: one or many independent worlds advanced together, each step the minimum of one incremental potential
//   E(x) = |x - x~|^2_M / (2 h^2) + elasticity + affine orthogonality + barrier + friction + joints + drives + stitches
//   [J]
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/device/device.hpp"
#include "host/model/checkpoint.hpp"
#include "host/model/physical_scene.hpp"
#include "host/model/scene_velocity.hpp"
#include "host/model/world_state.hpp"
#include "host/physics/step/phase_clock.hpp"

namespace pvg {

// One sentence that names all of it.
std::string describe(const StepEvent& event, const std::string& scene);

// A step that could not be done, of one world or more: names body, element and time. These worlds stay where they last
// were well; the others have done their step.
struct StepFailure : Failure {
  StepFailure(const std::string& what, std::vector<StepEvent> events) : Failure(what), events(std::move(events)) {}
  std::vector<StepEvent> events;  // the last one of each world that failed
};

class Simulation {
 public:
  // Refuses scenes that begin with intersections, naming the bodies. Worlds share the device, the time step and
  // the settings of the solve; scenes that differ in them are refused.
  Simulation(Device& device, std::span<const PhysicalScene> worlds);
  Simulation(Device& device, const PhysicalScene& world) : Simulation(device, std::span(&world, 1)) {}
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  // targets: for each world, one absolute target for each joint with a drive, in the order of PhysicalScene::joints
  // [rad or m]. Those of retired worlds are not read.
  std::vector<StepReport> step(std::span<const std::vector<double>> targets);
  StepReport step(const std::vector<double>& targets) { return step(std::span(&targets, 1)).front(); }

  // How far each node of a world probably moves in its next step, such as it did in a simulation that was nearly the
  // same: Newton's method starts there, instead of where the velocities lead.  [n_nodes of the world x 3, m]
  void expect(std::size_t world, std::vector<double> motion);

  // What the last step cost each world, also where it threw a StepFailure.  [n_worlds]
  const std::vector<StepReport>& reports() const;

  // This world takes no further steps and stays as it is, until it resumes: one that failed would fail again at the
  // same cost.
  void retire(std::size_t world);
  void resume(std::size_t world);

  Checkpoint checkpoint() const;
  // Throws a UsageError where the checkpoint is not of these scenes. Contacts and forces show after the next step.
  void restore(const Checkpoint& checkpoint);

  // The same of each world by itself, as if it were alone; worlds without one stay as they are.  [n_worlds]
  std::vector<Checkpoint> world_checkpoints() const;
  void restore_worlds(std::span<const std::optional<Checkpoint>> worlds);

  std::size_t n_worlds() const;
  const WorldState& state(std::size_t world = 0) const;
  // At the end of the last step; read from the device at each call.
  SceneVelocity velocity(std::size_t world = 0) const;

  // Counts the time of each phase from now on; this costs some time itself.
  void measure_phases();
  const PhaseSeconds& phase_seconds() const;
  // What it asked of the device so far, without what came before measure_phases() or restart_counts().
  SolverCounts counts() const;
  void restart_counts();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
