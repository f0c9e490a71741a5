#include "host/identify/sensing/world.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/physics/energies/effects.hpp"
#include "host/physics/step/actuator.hpp"

namespace pvg::diagnose {
namespace {

constexpr std::size_t LARGE_WORLD = 1000;  // nodes

}  // namespace

PhysicalScene world_of(const Problem& problem, const PhysicalScene& variant, const Window& window,
                       const InitialState& initial) {
  PhysicalScene scene = variant;
  const Run& run = problem.runs[std::size_t(window.run)];
  for (const SceneChange& change : run.changes) change(scene);
  // a late clock lets a world go on after its window
  add_pushes(run.pushes, window.start, window.end + criteria().late_clock_most, scene);
  start_at(problem, initial, scene);
  scene.separates_start = true;  // a measured start may cut a little into what the body rests on
  for (const PrescribedPath& prescribed : problem.runs[std::size_t(window.run)].prescribed) {
    RigidBody& body = scene.rigid_bodies[std::size_t(prescribed.rigid)];
    body.path.clear();
    for (const PathPoint& point : prescribed.path) {
      const double time = point.time - window.start;
      if (time <= 0) body.path.clear();  // the last one before the start becomes the first
      body.path.push_back({std::max(time, 0.0), point.pose});
    }
    if (!body.path.empty()) body.pose = body.path.front().pose;
  }
  return scene;
}

std::vector<double> targets_of(const PhysicalScene& scene, const Run& run, double time, double h) {
  std::vector<double> targets;
  std::size_t driven = 0;
  // implicit Euler lets a torque act over the whole step; to BDF2 one of half a step earlier is late
  const double back = scene.solver.integrator == SolverSettings::Integrator::implicit_euler ? h / 2 : 0;
  for (const Joint& joint : scene.joints) {
    if (!is_driven(joint)) continue;
    targets.push_back(run.targets[driven++].at(joint.drive.mode == Drive::Mode::torque ? time - back : time));
  }
  return targets;
}

DriveMemory memory_of(const PhysicalScene& scene, const Run& run, double time, double h) {
  const int n_steps = int(std::ceil(std::min(time - run.t.front(), criteria().drive_memory) / h));
  const std::vector<double> first = targets_of(scene, run, time - n_steps * h, h);
  Actuators actuators(with_effects(scene), first);
  DriveMemory memory{first, {}};
  for (int ago = n_steps - 1; ago >= 0; --ago) {
    const std::vector<double> targets = targets_of(scene, run, time - ago * h, h);
    memory.command = actuators.command(targets, memory.command);
    actuators.accept(targets);
  }
  memory.past = actuators.past();
  return memory;
}

std::size_t n_nodes(const PhysicalScene& scene) {
  std::size_t n = 4 * scene.rigid_bodies.size();
  for (const SoftBody& body : scene.soft_bodies) n += body.mesh.points.size();
  for (const Cloth& cloth : scene.cloths) n += cloth.mesh.points.size();
  return n;
}

bool is_large(const PhysicalScene& scene) { return n_nodes(scene) > LARGE_WORLD; }

}  // namespace pvg::diagnose
