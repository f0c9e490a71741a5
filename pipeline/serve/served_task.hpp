// A task that someone else steps: reset to the start of an episode, told where the joints are to be, asked what is
// there. Every state has the bits that `generate` gives for the same targets, every picture those of the same frame.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/dataset/environment_state.hpp"
#include "host/dataset/packed_columns.hpp"
#include "host/device/device.hpp"
#include "host/formats/lut_file.hpp"
#include "host/load/build_scene.hpp"
#include "host/pictures/picture.hpp"
#include "host/render/renderer.hpp"
#include "pipeline/episode/force_grasp.hpp"
#include "pipeline/episode/motion_plan.hpp"
#include "pipeline/episode/shared_simulation.hpp"
#include "pipeline/episode/success.hpp"
#include "pipeline/serve/grasps.hpp"
#include "pipeline/serve/surfaces.hpp"

namespace pvg {

// A column of actions and of joint observations.
struct ServedColumn {
  PackedColumn packed;
  double low = 0, high = 0;  // what the joints' stops allow [rad or m]; infinite where there are none
};

// What holds for every episode of the task.
struct ServedFacts {
  std::vector<ServedColumn> columns;
  std::vector<std::string> driven;     // names of the joints with a drive, as the columns of /a in states.h5
  std::vector<std::string> objects;    // names, as in environment_state
  std::vector<ClothKeypoints> cloths;  // of the scene's, in their order; after the objects in environment_state
  std::size_t steps_per_period = 1;    // of a period, 1 / frames_per_second
};

class ServedTask {
 public:
  // rendering: nothing where no pictures will be asked for. The devices must outlive it.
  ServedTask(Task task, Device& physics, Device* rendering);
  // One more world of the same task, in the same simulation.
  ServedTask(const ServedTask& first, Device* rendering);

  const Task& task() const { return task_; }
  bool renders() const { return rendering_ != nullptr; }
  const ServedFacts& facts() const { return facts_; }

  // What is to be done, by advance_together(): the start of an episode, or next steps. Each throws a UsageError, and
  // nothing changes, where it cannot be asked for.
  void ask_reset(std::uint64_t seed, std::uint64_t episode);  // ends the episode under way
  // One period, in which the targets go from where they are to the action on straight lines.  [n_columns, rad or m]
  void ask_action(std::span<const double> action);
  // As many steps as there are rows.  [n_steps][n_driven, rad or m]
  void ask_targets(std::vector<std::vector<double>> targets);
  // One period of the motion that `generate` plans for this episode; it must not have begun otherwise. False: the
  // motion has ended. A motion that cannot be planned ends the episode.
  bool ask_plan();

  // Does what was asked of each, one step of all of them after the other. All share one simulation. Returns for each
  // why its episode cannot begin (bodies that intersect), and then it has none; else an empty text.
  static std::vector<std::string> advance_together(std::span<ServedTask* const> tasks);

  // The same alone, at once. A UsageError where an episode cannot begin.
  void reset(std::uint64_t seed, std::uint64_t episode);
  void act(std::span<const double> action);
  void follow(const std::vector<std::vector<double>>& targets);
  bool follow_plan();
  // Periods of the planned motion; 0 where it cannot be planned, and then the episode goes on without.
  std::size_t n_planned_periods();
  const std::string& why_unplanned() const { return why_unplanned_; }

  bool is_over() const { return !reason_.empty(); }
  const std::string& reason() const { return reason_; }  // why the episode is over: a step that could not be done
  std::size_t n_steps() const { return n_steps_; }       // since the reset

  const TaskScene& built() const;
  const WorldState& state() const;
  std::vector<double> joints() const;       // [n_columns, rad or m]
  std::vector<double> environment() const;  // as environment_columns of objects and cloths
  const std::vector<double>& targets() const { return targets_; }
  // What speaks against success, if the episode ended now; nothing: it would be one.
  std::optional<std::string> failure() const;
  Measured measured() const { return monitor().measured(); }
  const std::vector<EpisodeEvent>& events() const { return grasps_->events(); }
  // Bodies whose surfaces intersect now, such as "beaker and table"; empty: none. By an exact test of its own.
  std::string intersection();
  // What the camera sees; of the start it is a frame of its own.
  Picture8 picture(std::size_t camera);

 private:
  // Steps that are asked for and not done yet.
  struct Asked {
    bool begins = false;                       // an episode
    std::vector<std::vector<double>> targets;  // [n_steps][n_driven, rad or m]
    std::size_t n_done = 0, n_of_plan = 0;     // of these; of the planned motion
  };
  void demand_running() const;
  const SuccessMonitor& monitor() const;
  std::optional<std::vector<double>> next_targets();
  void join(std::unique_ptr<SharedSimulation::World> world);
  void take_step(const std::vector<double>& targets, const std::exception_ptr& error);
  void advance();
  bool make_plan();

  Task task_;
  std::shared_ptr<SharedSimulation> simulation_;  // of all worlds of the task
  Device* rendering_;
  ServedFacts facts_;
  std::optional<Lut> lut_;

  // of the episode
  std::uint64_t seed_ = 0, episode_ = 0;
  std::unique_ptr<TaskScene> built_;
  std::unique_ptr<SharedSimulation::World> world_;
  std::unique_ptr<SuccessMonitor> monitor_;
  std::unique_ptr<Grasps> grasps_;
  std::unique_ptr<Surfaces> surfaces_;  // where they were asked for
  std::unique_ptr<Renderer> renderer_;
  std::unique_ptr<MotionPlan> plan_;
  std::unique_ptr<ForceGrasp> plan_grasp_;
  bool follows_plan_ = false;               // the first step was of the plan
  std::vector<double> targets_;             // [n_driven, rad or m] of the last step
  std::vector<SceneState> last_states_;     // of the period under way or done, for pictures of motion
  std::vector<std::size_t> object_bodies_;  // [n_objects] of Scene::rigid_bodies
  std::size_t n_steps_ = 0;
  std::string reason_, why_unplanned_;
  Asked asked_;
};

// Worlds of one task that step together, each with the bits that it has alone.
class ServedWorlds {
 public:
  // n: at least 1
  ServedWorlds(const Task& task, Device& physics, Device* rendering, std::size_t n);
  std::size_t size() const { return tasks_.size(); }
  ServedTask& operator[](std::size_t world) { return *tasks_.at(world); }
  const ServedTask& front() const { return *tasks_.front(); }

 private:
  std::vector<std::unique_ptr<ServedTask>> tasks_;
};

}  // namespace pvg
