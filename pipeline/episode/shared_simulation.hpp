// Episodes that step together, each in a world of one simulation. An episode joins when its start is known and leaves
// when it has ended or failed; the others go on. A world's bits do not depend on who else is there, nor on when they
// come.
//
// Either each episode has a thread of its own, which waits in World::step() until all that are under way have said
// where their joints are to be; the last one steps for all. One that has not stepped yet is not waited for. Or one
// thread steps several worlds by SharedSimulation::step(). Whoever joins or leaves is a change of scenes: the
// simulation is made anew and the worlds that stay are put where they were.
#pragma once
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/step/simulation.hpp"

namespace pvg {

class SharedSimulation {
 public:
  explicit SharedSimulation(Device& device) : device_(device) {}
  SharedSimulation(const SharedSimulation&) = delete;
  Device& device() { return device_; }

  class World {
   public:
    ~World();  // leaves
    World(const World&) = delete;
    const WorldState& state() const;
    // As Simulation::step() of this world alone. A world that failed takes no further steps.
    StepReport step(const std::vector<double>& targets);

   private:
    friend class SharedSimulation;
    struct Member;
    World(SharedSimulation& shared, std::shared_ptr<Member> member);
    SharedSimulation& shared_;
    std::shared_ptr<Member> member_;
  };

  // A UsageError where the scene cannot be simulated or begins with intersections; the others hear nothing of it. All
  // worlds must have one time step and one set of solver settings: be of one task.
  std::unique_ptr<World> join(const PhysicalScene& scene);
  // Several at once, for which the simulation is made anew only once. A UsageError of one is one of all.
  std::vector<std::unique_ptr<World>> join(std::span<const PhysicalScene* const> scenes);

  // One step of these worlds; the others rest. Returns for each why its step could not be done, or nothing. Worlds that
  // are stepped so have no threads of their own.
  std::vector<std::exception_ptr> step(std::span<World* const> worlds, std::span<const std::vector<double>> targets);

 private:
  using Members = std::vector<std::shared_ptr<World::Member>>;
  void leave(World::Member& member);
  void make_simulation(const Members& members);
  void step_if_all_wait();
  void step_waiting();
  void step_all();

  Device& device_;
  std::mutex mutex_;                        // of all that follows; held while the device steps
  std::condition_variable has_stepped_;     // of all members
  std::unique_ptr<Simulation> simulation_;  // of `members_`, and of worlds whose episode has left
  Members members_;
  std::size_t steps_since_change_ = 0;
};

// How many episodes are to be simulated at the same time, as many as fit into half of the memory: on a CPU one for each
// compute unit, beside each other, since in one solve they took longer than one after the other; on a GPU, where it was
// not measured, up to 32 that step together. bytes: of one world on the device. docs/measured/2026-11-28_worlds.md
std::size_t automatic_worlds(const DeviceInfo& device, std::size_t bytes);

}  // namespace pvg
