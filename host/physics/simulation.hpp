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
#include "host/physics/phase_clock.hpp"
#include "host/scene/scene.hpp"
#include "host/scene/state.hpp"

namespace pvg {

// One contact after a step. Forces act on the first body; the second feels the opposite.
struct ContactForce {
  enum class Kind { point_triangle = 0, edge_edge = 1, point_plane = 2 };
  Kind kind = Kind::point_triangle;
  int first = -1, second = -1;         // bodies: rigid bodies first, then soft ones at n_rigid + i, then cloths
  Vec3 point = Vec3::Zero();           // midway between the closest points, world [m]
  Vec3 normal = Vec3::Zero();          // unit, from the second body to the first
  double gap = 0;                      // [m]
  double normal_force = 0;             // [N], >= 0
  Vec3 friction_force = Vec3::Zero();  // [N]
};

// What all contacts together do to one body.
struct BodyForce {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // about the centre of mass of a rigid body, the mean of its nodes of another [N m]
};

// What all contacts of one pair of bodies do to the first of them.
struct PairForce {
  int first = -1, second = -1;
  Vec3 normal = Vec3::Zero(), friction = Vec3::Zero();  // [N]
};

struct WorldState : SceneState {
  std::vector<double> joint_position;     // [n_joints, rad or m], 0 for fixed and spherical joints
  std::vector<double> joint_effort;       // [n_joints, N m or N] what the drive exerts along q, feed-forward included
  std::vector<double> joint_stop_effort;  // the same of the stops, 0 inside the limits
  std::vector<double> joint_damping_effort;  // the same of the joint's own damping
  std::vector<ContactForce> contacts;
  std::vector<BodyForce> body_force;  // [n_bodies] rigid, then soft, then cloth
  std::vector<PairForce> pair_force;  // of the pairs that touch, sorted
};

// Why an attempt at a step was given up.
struct StepEvent {
  enum class Kind { not_finite, inverted_element, stalled, exhausted_line_search };
  Kind kind = Kind::stalled;
  std::size_t world = 0;
  double time = 0, length = 0;  // of the attempt: where it began, how long it was [s]
  std::string body;             // where it showed; empty: nowhere in particular
  int element = -1;             // of that body: the tetrahedron if inverted, else the node; -1: the body as a whole
  std::string detail;           // a sentence's end
};
// One sentence that names all of it.
std::string describe(const StepEvent& event, const std::string& scene);

// What one step cost, per world.
struct StepReport {
  int newton = 0;                 // iterations
  int cg = 0;                     // iterations of conjugate gradients, summed
  int contacts = 0;               // active at the end
  int retries = 0;                // halvings of the step that were needed
  double residual = 0;            // largest speed of the last Newton correction [m/s]
  double min_gap = 0;             // smallest contact gap at the end [m]; infinite without contacts
  std::vector<StepEvent> events;  // of the attempts that failed, halved steps among them
};

// A step that could not be done, of one world or more: names body, element and time. These worlds stay where they last
// were well; the others have done their step.
struct StepFailure : Failure {
  StepFailure(const std::string& what, std::vector<StepEvent> events) : Failure(what), events(std::move(events)) {}
  std::vector<StepEvent> events;  // the last one of each world that failed
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

  // This world takes no further steps and stays as it is: one that failed would fail again at the same cost.
  void retire(std::size_t world);

  Checkpoint checkpoint() const;
  // Throws a UsageError where the checkpoint is not of these scenes. Contacts and forces show after the next step.
  void restore(const Checkpoint& checkpoint);

  std::size_t n_worlds() const;
  const WorldState& state(std::size_t world = 0) const;

  // Counts the time of each phase from now on; this costs some time itself.
  void measure_phases();
  const PhaseSeconds& phase_seconds() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
