// The simulator: one or many independent worlds advanced together, each step the minimum of one incremental potential
//   E(x) = |x - x~|^2_M / (2 h^2) + elasticity + affine orthogonality + barrier + friction + joints + drives + stitches
//   [J]
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/checkpoint.hpp"
#include "host/scene/scene.hpp"
#include "host/scene/state.hpp"

namespace pvg {

// One contact after a step. Forces act on the first body; the second feels the opposite.
struct ContactForce {
  enum class Kind { point_triangle = 0, edge_edge = 1 };
  Kind kind = Kind::point_triangle;
  int first = -1, second = -1;         // bodies: rigid bodies first, then soft ones at n_rigid + i, then cloths
  Vec3 point = Vec3::Zero();           // midway between the closest points, world [m]
  Vec3 normal = Vec3::Zero();          // unit, from the second body to the first
  double gap = 0;                      // [m]
  double normal_force = 0;             // [N], >= 0
  Vec3 friction_force = Vec3::Zero();  // [N]
};

struct WorldState : SceneState {
  std::vector<double> joint_position;  // [n_joints, rad or m], 0 for fixed and spherical joints
  std::vector<double> joint_effort;    // [n_joints, N m or N] what the drive exerts along q, feed-forward included
  std::vector<ContactForce> contacts;
};

// What one step cost, per world.
struct StepReport {
  int newton = 0;       // iterations
  int cg = 0;           // iterations of conjugate gradients, summed
  int contacts = 0;     // active at the end
  int retries = 0;      // halvings of the step that were needed
  double residual = 0;  // largest speed of the last Newton correction [m/s]
  double min_gap = 0;   // smallest contact gap at the end [m]; infinite without contacts
};

// A step that could not be done: names body, element and time; the state before it is kept.
struct StepFailure : Failure {
  using Failure::Failure;
};

class Simulation {
 public:
  // Refuses scenes that begin with intersections, naming the bodies. Worlds share the device and the time step.
  Simulation(Device& device, std::span<const Scene> worlds);
  Simulation(Device& device, const Scene& world) : Simulation(device, std::span(&world, 1)) {}
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  // targets: for each world, one absolute target for each joint with a drive, in the order of Scene::joints [rad or m]
  std::vector<StepReport> step(std::span<const std::vector<double>> targets);
  StepReport step(const std::vector<double>& targets) { return step(std::span(&targets, 1)).front(); }

  Checkpoint checkpoint() const;
  // Throws a UsageError where the checkpoint is not of these scenes.
  void restore(const Checkpoint& checkpoint);

  std::size_t n_worlds() const;
  const WorldState& state(std::size_t world = 0) const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
