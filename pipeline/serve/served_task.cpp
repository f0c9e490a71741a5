#include "pipeline/serve/served_task.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/counted.hpp"
#include "host/dataset/states_file.hpp"
#include "host/render/motion.hpp"
#include "pipeline/episode/episode.hpp"
#include "pipeline/episode/picture_stages.hpp"
#include "pipeline/serve/requests.hpp"

namespace pvg {
namespace {

constexpr const char* NO_EPISODE = "no episode has begun; send a reset first";

bool is_object(const Task& task, const std::string& body) {
  return std::any_of(task.objects.begin(), task.objects.end(), [&](const auto& object) { return object.name == body; });
}

ServedColumn served(const PackedColumn& packed, const Scene& scene, const std::vector<std::size_t>& driven) {
  ServedColumn column{packed, 0, 0};
  for (const std::size_t i : packed.joints) {
    const Joint& joint = scene.joints[driven[i]];
    const bool has_stops = joint.lower != 0 || joint.upper != 0;
    column.low += has_stops ? joint.lower : -std::numeric_limits<double>::infinity();
    column.high += has_stops ? joint.upper : std::numeric_limits<double>::infinity();
  }
  return column;
}

ServedFacts facts_of(const Task& task, const TaskScene& built) {
  const Scene& scene = built.scene;
  ServedFacts facts;
  std::vector<std::string> links;
  for (const RigidBody& body : scene.rigid_bodies)
    (is_object(task, body.name) ? facts.objects : links).push_back(body.name);
  for (const Cloth& cloth : scene.cloths) facts.cloths.push_back(cloth_keypoints(cloth.name, cloth.mesh.points));
  const std::vector<std::size_t> driven = driven_joints(scene);
  for (const std::size_t joint : driven) facts.driven.push_back(scene.joints[joint].name);
  for (const PackedColumn& column : find_columns(facts.driven, find_tools(robots_of(task), links, facts.driven)))
    facts.columns.push_back(served(column, scene, driven));
  facts.steps_per_period = steps_per_frame(task.render.frames_per_second, scene.solver.time_step);
  return facts;
}

}  // namespace

ServedTask::ServedTask(Task task, Device& physics, Device* rendering)
    : task_(std::move(task)),
      simulation_(std::make_shared<SharedSimulation>(physics)),
      rendering_(rendering),
      facts_(facts_of(task_, build_scene_at_middle(task_))) {
  if (!task_.render.lut.empty()) lut_ = read_lut(task_.render.lut);
}

ServedTask::ServedTask(const ServedTask& first, Device* rendering)
    : task_(first.task_),
      simulation_(first.simulation_),
      rendering_(rendering),
      facts_(first.facts_),
      lut_(first.lut_) {}

const TaskScene& ServedTask::built() const {
  if (!built_) throw UsageError(NO_EPISODE);
  return *built_;
}

const WorldState& ServedTask::state() const {
  if (!world_) throw UsageError(NO_EPISODE);
  return world_->state();
}

const SuccessMonitor& ServedTask::monitor() const {
  if (!monitor_) throw UsageError(NO_EPISODE);
  return *monitor_;
}

void ServedTask::ask_reset(std::uint64_t seed, std::uint64_t episode) {
  auto built = std::make_unique<TaskScene>(build_scene(task_, seed, episode));
  renderer_.reset();
  surfaces_.reset();
  grasps_.reset();
  monitor_.reset();
  world_.reset();
  plan_grasp_.reset();
  plan_.reset();
  seed_ = seed;
  episode_ = episode;
  n_steps_ = 0;
  follows_plan_ = false;
  reason_.clear();
  why_unplanned_.clear();
  asked_ = {};
  built_ = std::move(built);
  asked_.begins = true;
}

void ServedTask::join(std::unique_ptr<SharedSimulation::World> world) {
  const Scene& scene = built_->scene;
  object_bodies_.clear();
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i)
    if (is_object(task_, scene.rigid_bodies[i].name)) object_bodies_.push_back(i);
  targets_.clear();
  for (const std::size_t joint : driven_joints(scene)) targets_.push_back(scene.joints[joint].initial);
  world_ = std::move(world);
  monitor_ = std::make_unique<SuccessMonitor>(task_, scene, hands_of(*built_), world_->state());
  grasps_ = std::make_unique<Grasps>(*built_);
  last_states_ = {world_->state()};
}

void ServedTask::demand_running() const {
  if (!world_) throw UsageError(NO_EPISODE);
  if (is_over()) throw UsageError("the episode is over (" + reason_ + "); send a reset first");
}

void ServedTask::take_step(const std::vector<double>& targets, const std::exception_ptr& error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const StepFailure& failure) {
    reason_ = failure.what();
    asked_ = {};
    return;
  }
  targets_ = targets;
  ++n_steps_;
  const WorldState& now = world_->state();
  grasps_->observe(now);
  monitor_->observe(now, grasps_->phase());
  if (n_steps_ % facts_.steps_per_period == 1 || facts_.steps_per_period == 1) last_states_.clear();
  last_states_.push_back(now);
}

std::optional<std::vector<double>> ServedTask::next_targets() {
  if (asked_.n_of_plan > 0) {
    --asked_.n_of_plan;
    return plan_grasp_->target(n_steps_, world_->state());
  }
  if (asked_.n_done < asked_.targets.size()) return asked_.targets[asked_.n_done++];
  asked_ = {};
  return std::nullopt;
}

std::vector<std::string> ServedTask::advance_together(std::span<ServedTask* const> tasks) {
  std::vector<std::string> errors(tasks.size());
  if (tasks.empty()) return errors;
  SharedSimulation& shared = *tasks.front()->simulation_;
  std::vector<std::size_t> beginning;
  std::vector<const PhysicalScene*> scenes;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!std::exchange(tasks[i]->asked_.begins, false)) continue;
    beginning.push_back(i);
    scenes.push_back(&tasks[i]->built_->scene);
  }
  try {
    std::vector<std::unique_ptr<SharedSimulation::World>> worlds;
    if (!scenes.empty()) worlds = shared.join(scenes);
    for (std::size_t k = 0; k < worlds.size(); ++k) tasks[beginning[k]]->join(std::move(worlds[k]));
  } catch (const UsageError&) {  // one of them cannot begin: which, and the others do
    for (std::size_t k = 0; k < scenes.size(); ++k) try {
        tasks[beginning[k]]->join(shared.join(*scenes[k]));
      } catch (const UsageError& error) {
        errors[beginning[k]] = error.what();
      }
  }
  while (true) {
    std::vector<ServedTask*> stepping;
    std::vector<SharedSimulation::World*> worlds;
    std::vector<std::vector<double>> targets;
    for (ServedTask* task : tasks)
      if (std::optional<std::vector<double>> next = task->next_targets()) {
        stepping.push_back(task);
        worlds.push_back(task->world_.get());
        targets.push_back(std::move(*next));
      }
    if (stepping.empty()) return errors;
    const std::vector<std::exception_ptr> failures = shared.step(worlds, targets);
    for (std::size_t i = 0; i < stepping.size(); ++i) stepping[i]->take_step(targets[i], failures[i]);
  }
}

void ServedTask::advance() {
  ServedTask* const only = this;
  const std::string error = advance_together(std::span(&only, 1)).front();
  if (!error.empty()) throw UsageError(error);
}

void ServedTask::reset(std::uint64_t seed, std::uint64_t episode) {
  ask_reset(seed, episode);
  advance();
}

void ServedTask::act(std::span<const double> action) {
  ask_action(action);
  advance();
}

void ServedTask::follow(const std::vector<std::vector<double>>& targets) {
  ask_targets(targets);
  advance();
}

bool ServedTask::follow_plan() {
  const bool goes_on = ask_plan();
  advance();
  return goes_on;
}

void ServedTask::ask_action(std::span<const double> action) {
  demand_running();
  if (action.size() != facts_.columns.size())
    throw UsageError("an action has " + counted(facts_.columns.size(), "number") + ", this one has " +
                     std::to_string(action.size()));
  if (!std::all_of(action.begin(), action.end(), [](double number) { return std::isfinite(number); }))
    throw UsageError("an action holds what is not a finite number");
  const std::vector<double>& from = targets_;
  std::vector<double> to = from;
  for (std::size_t c = 0; c < action.size(); ++c) {
    const std::vector<std::size_t>& joints = facts_.columns[c].packed.joints;
    for (const std::size_t joint : joints) to[joint] = action[c] / double(joints.size());
  }
  check_targets(built_->scene, std::span(&to, 1));
  for (std::size_t c = 0; c < action.size(); ++c) {
    // a gripper is told to close beyond its stop, so that it presses
    const ServedColumn& column = facts_.columns[c];
    if (!column.packed.is_width && (action[c] < column.low || action[c] > column.high))
      grasps_->add("out_of_reach", column.packed.name, state().time);
  }
  const std::size_t n = facts_.steps_per_period;
  asked_ = {};
  for (std::size_t i = 1; i <= n; ++i) {
    std::vector<double>& targets = asked_.targets.emplace_back(to);  // the last ones to the bit
    for (std::size_t j = 0; i < n && j < to.size(); ++j)
      targets[j] = from[j] + double(i) / double(n) * (to[j] - from[j]);
  }
}

void ServedTask::ask_targets(std::vector<std::vector<double>> targets) {
  demand_running();
  check_targets(built_->scene, targets);
  asked_ = {};
  asked_.targets = std::move(targets);
}

bool ServedTask::make_plan() {
  if (plan_) return true;
  const TaskScene& scene = built();
  try {
    plan_ = std::make_unique<MotionPlan>(plan_episode(task_, scene));
  } catch (const UsageError& error) {  // out of reach: this draw of the start is no good
    why_unplanned_ = error.what();
    return false;
  }
  plan_grasp_ = std::make_unique<ForceGrasp>(*plan_);
  return true;
}

std::size_t ServedTask::n_planned_periods() {
  return make_plan() ? plan_->targets.size() / facts_.steps_per_period : 0;
}

bool ServedTask::ask_plan() {
  demand_running();
  if (!follows_plan_ && n_steps_ > 0)
    throw UsageError("the planned motion begins where an episode begins; send a reset before it");
  asked_ = {};
  if (!make_plan()) {
    reason_ = why_unplanned_;
    return true;
  }
  if (n_steps_ + facts_.steps_per_period > plan_->targets.size()) return false;
  asked_.n_of_plan = facts_.steps_per_period;
  follows_plan_ = true;
  return true;
}

std::vector<double> ServedTask::joints() const {
  const std::vector<std::size_t> driven = driven_joints(built().scene);
  std::vector<double> numbers;
  for (const ServedColumn& column : facts_.columns) {
    double sum = 0;
    for (const std::size_t joint : column.packed.joints) sum += state().joint_position[driven[joint]];
    numbers.push_back(sum);
  }
  return numbers;
}

std::vector<double> ServedTask::environment() const {
  std::vector<double> numbers;
  for (const std::size_t body : object_bodies_) {
    const auto pose = pose_numbers(state().rigid[body]);
    numbers.insert(numbers.end(), pose.begin(), pose.end());
  }
  for (std::size_t i = 0; i < facts_.cloths.size(); ++i) {
    const auto keypoints = keypoint_numbers(facts_.cloths[i], state().cloth[i]);
    numbers.insert(numbers.end(), keypoints.begin(), keypoints.end());
  }
  return numbers;
}

std::optional<std::string> ServedTask::failure() const {
  if (is_over()) return reason_;
  const SuccessMonitor& judge = monitor();
  if (n_steps_ == 0) return "nothing was done yet";  // conditions judge steps
  return judge.failure();
}

std::string ServedTask::intersection() {
  const WorldState& now = state();
  if (!surfaces_) surfaces_ = std::make_unique<Surfaces>(built_->scene);
  return surfaces_->meeting(now);
}

Picture8 ServedTask::picture(std::size_t camera) {
  if (!rendering_) throw UsageError("this server makes no pictures: it was started with --no-render");
  const Scene& scene = built().scene;
  if (!renderer_) {
    renderer_ = std::make_unique<Renderer>(*rendering_, scene, picture_settings(task_, seed_, episode_));
  }
  const std::uint32_t frame = n_steps_ == 0 ? START_FRAME : std::uint32_t((n_steps_ - 1) / facts_.steps_per_period);
  renderer_->set_state(last_states_.back());
  RenderedFrame rendered = renderer_->render(
      int(camera), frame, [&](double time) { return state_at(last_states_, time); }, last_states_.back().time);
  if (lut_) apply_lut(*lut_, rendered.rgb);
  return encode_srgb8(rendered.rgb, rendered.width, rendered.height);
}

ServedWorlds::ServedWorlds(const Task& task, Device& physics, Device* rendering, std::size_t n) {
  tasks_.push_back(std::make_unique<ServedTask>(task, physics, rendering));
  while (tasks_.size() < n) tasks_.push_back(std::make_unique<ServedTask>(*tasks_.front(), rendering));
}

}  // namespace pvg
