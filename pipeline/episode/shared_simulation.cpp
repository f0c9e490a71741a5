#include "pipeline/episode/shared_simulation.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace pvg {
namespace {

// A world whose episode has left costs its share of every step, but making the simulation anew takes as long as several
// steps of all. So it is kept for so many steps, in which the next episode mostly comes and takes its place.
constexpr std::size_t STEPS_WITH_EMPTY_WORLDS = 30;

}  // namespace

struct SharedSimulation::World::Member {
  explicit Member(const PhysicalScene& scene) : scene(scene) {}
  PhysicalScene scene;
  std::size_t place = 0;  // in the simulation
  WorldState state;       // after its last step
  bool has_begun = false, waits = false, has_left = false;
  std::vector<double> targets;  // of the step that it waits for
  StepReport report;            // of its last step
  std::exception_ptr error;     // why its last step could not be done
};

SharedSimulation::World::World(SharedSimulation& shared, std::shared_ptr<Member> member)
    : shared_(shared), member_(std::move(member)) {}

SharedSimulation::World::~World() {
  const std::lock_guard lock(shared_.mutex_);
  shared_.leave(*member_);
}

const WorldState& SharedSimulation::World::state() const { return member_->state; }

StepReport SharedSimulation::World::step(const std::vector<double>& targets) {
  std::unique_lock lock(shared_.mutex_);
  if (member_->has_left) throw UsageError("a world that failed takes no further steps");
  member_->targets = targets;
  member_->has_begun = member_->waits = true;
  shared_.step_if_all_wait();
  shared_.has_stepped_.wait(lock, [&] { return !member_->waits; });
  if (!member_->error) return member_->report;
  shared_.leave(*member_);
  std::rethrow_exception(member_->error);
}

std::unique_ptr<SharedSimulation::World> SharedSimulation::join(const PhysicalScene& scene) {
  const PhysicalScene* const only = &scene;
  return std::move(join(std::span(&only, 1)).front());
}

std::vector<std::unique_ptr<SharedSimulation::World>> SharedSimulation::join(
    std::span<const PhysicalScene* const> scenes) {
  const std::lock_guard lock(mutex_);
  Members members = members_;
  for (const PhysicalScene* scene : scenes) members.push_back(std::make_shared<World::Member>(*scene));
  make_simulation(members);
  std::vector<std::unique_ptr<World>> worlds;
  for (std::size_t i = members_.size(); i < members.size(); ++i) {
    members[i]->state = simulation_->state(members[i]->place);
    worlds.push_back(std::unique_ptr<World>(new World(*this, members[i])));
  }
  members_ = std::move(members);
  return worlds;
}

std::vector<std::exception_ptr> SharedSimulation::step(std::span<World* const> worlds,
                                                       std::span<const std::vector<double>> targets) {
  const std::lock_guard lock(mutex_);
  for (const World* world : worlds)
    if (world->member_->has_left) throw UsageError("a world that failed takes no further steps");
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    worlds[i]->member_->targets = targets[i];
    worlds[i]->member_->waits = true;
  }
  step_waiting();
  std::vector<std::exception_ptr> errors;
  for (World* world : worlds) {
    errors.push_back(world->member_->error);
    if (errors.back()) leave(*world->member_);
  }
  return errors;
}

void SharedSimulation::leave(World::Member& member) {
  if (std::exchange(member.has_left, true)) return;
  std::erase_if(members_, [&](const auto& other) { return other.get() == &member; });
  steps_since_change_ = 0;
  if (members_.empty())
    simulation_.reset();
  else
    simulation_->retire(member.place);
  step_if_all_wait();  // perhaps it was the one that all waited for
}

// The simulation of these members, of which the last ones may be new. If it throws, all is as it was before.
void SharedSimulation::make_simulation(const Members& members) {
  std::vector<PhysicalScene> scenes;
  for (const auto& member : members) scenes.push_back(member->scene);
  auto made = std::make_unique<Simulation>(device_, scenes);
  std::vector<std::optional<Checkpoint>> kept(members.size());
  if (simulation_) {
    const std::vector<Checkpoint> worlds = simulation_->world_checkpoints();
    for (std::size_t i = 0; i < members.size(); ++i)
      if (i < members_.size()) kept[i] = worlds[members[i]->place];
    made->restore_worlds(kept);
  }
  for (std::size_t i = 0; i < members.size(); ++i) members[i]->place = i;
  simulation_ = std::move(made);
}

void SharedSimulation::step_if_all_wait() {
  bool anybody_waits = false;
  for (const auto& member : members_) {
    if (member->has_begun && !member->waits) return;
    anybody_waits |= member->waits;
  }
  if (!anybody_waits) return;
  step_waiting();
  has_stepped_.notify_all();
}

void SharedSimulation::step_waiting() {
  try {
    step_all();
  } catch (...) {  // of the device: it is everybody's
    for (const auto& member : members_)
      if (member->waits) member->error = std::current_exception();
  }
  for (const auto& member : members_) member->waits = false;
}

void SharedSimulation::step_all() {
  if (simulation_->n_worlds() > members_.size() && steps_since_change_ >= STEPS_WITH_EMPTY_WORLDS)
    make_simulation(members_);
  ++steps_since_change_;
  std::vector<std::vector<double>> targets(simulation_->n_worlds());
  for (const auto& member : members_) {
    if (!member->waits) {
      simulation_->retire(member->place);
      continue;
    }
    simulation_->resume(member->place);
    targets[member->place] = member->targets;
  }
  std::vector<StepEvent> failures;
  try {
    simulation_->step(targets);
  } catch (const StepFailure& failure) {
    failures = failure.events;
  }
  for (const auto& member : members_) {
    if (!member->waits) continue;
    member->state = simulation_->state(member->place);
    member->report = simulation_->reports()[member->place];
    for (StepEvent& event : member->report.events) event.world = 0;
    for (const StepEvent& event : failures)
      if (event.world == member->place) {
        StepEvent alone = event;
        alone.world = 0;
        member->error = std::make_exception_ptr(StepFailure(describe(alone, member->scene.name), {alone}));
      }
  }
}

std::size_t automatic_worlds(const DeviceInfo& device, std::size_t bytes) {
  constexpr std::size_t ON_A_GPU = 32;  // not measured
  const std::size_t most = device.is_gpu ? ON_A_GPU : std::max(device.compute_units, 1u);
  // while one joins, the simulation is there twice
  const std::size_t fit = device.memory_bytes / 2 / (2 * std::max<std::size_t>(bytes, 1));
  return std::clamp<std::size_t>(fit, 1, most);
}

}  // namespace pvg
