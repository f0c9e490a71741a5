// THE table: the one place that knows what runs when. Below it one function per row, of the same name.
#include "pipeline/episode/episode.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "host/base/hash.hpp"
#include "host/formats/lut_file.hpp"
#include "host/render/renderer.hpp"
#include "pipeline/episode/disabled_pairs.hpp"
#include "pipeline/episode/force_grasp.hpp"
#include "pipeline/episode/motion_plan.hpp"
#include "pipeline/episode/picture_stages.hpp"
#include "pipeline/episode/record.hpp"
#include "pipeline/episode/shown_scene.hpp"

namespace pvg {
namespace {

// ---- the fields -------------------------------------------------------------------------------------------------

// Physics on the device, one step at a time. The world is left once its last step is done, before the last frames are
// rendered: other episodes would wait for it.
struct PhysicsState {
  std::unique_ptr<SharedSimulation::World> world;
  std::size_t n_steps_planned = 0;
  std::unique_ptr<ForceGrasp> grasp;
  std::size_t n_steps = 0;  // done so far
};

struct JudgeState {
  std::unique_ptr<SuccessMonitor> monitor;
  std::vector<std::vector<Phase>> phase;  // [n_steps][n_robots]
  std::size_t n_steps = 0;                // judged so far
  SolverTotals totals;
};

struct RecordState {
  std::unique_ptr<EpisodeRecorder> recorder;
  std::function<void(std::size_t)> advance;
};

struct Target {
  std::vector<double> q;            // [n_driven, rad or m]
  int element = 0;                  // of Task::motion
  std::vector<double> disturbance;  // [n_driven]; empty: none
};

// clang-format off
//                                         name          shape                unit         state
const Field<MotionPlan> motion            ("motion",     "n_step x n_driven", "rad or m",  true);
const Field<PhysicsState> world           ("world",      "n_node x 3",        "m",         true);
const Field<JudgeState> verdict           ("verdict",    "1",                 "-",         true);
const Field<RecordState> recording        ("recording",  "1",                 "-",         true);
const Field<std::vector<Target>> targets  ("targets",    "steps x n_driven",  "rad or m");
const Field<std::vector<StepRecord>> steps("steps",      "steps",             "SI");
// clang-format on
using fields::shown, fields::images;

}  // namespace

void plan(const Access&), simulate(const Access&), map(const Access&), judge(const Access&), record(const Access&);

// clang-format off
Table episode_table() {
  return {
      // stage      reads                         writes                width  does
      {"plan",     {&motion},                    {&targets},            1,     plan},      // of all steps of the frame
      {"simulate", {&targets, &world},           {&world, &steps},      1,     simulate},  // these steps
      {"judge",    {&steps, &verdict},           {&verdict},            1,     judge},     // success and slip
      {"map",      {&steps},                     {&shown},              1,     map},       // what the frame shows
      render_stage(),                                                                      // every camera
      finish_stage(),                                                                      // noise, exposure, sensor
      encode_stage(),                                                                      // to 8 bits
      {"record",   {&steps, &images, &recording}, {&recording},         1,     record},
  };
}
// clang-format on

void plan(const Access& access) {
  const MotionPlan& whole = access.read(motion);
  for (std::size_t i = 0; i < whole.steps_per_frame; ++i) {
    const std::size_t step = access.frame() * whole.steps_per_frame + i;
    access.write(targets).push_back({whole.targets.at(step), whole.element.at(step),
                                     whole.disturbance.empty() ? std::vector<double>() : whole.disturbance.at(step)});
  }
}

void simulate(const Access& access) {
  PhysicsState& physics = access.write(world);
  for (const Target& target : access.read(targets)) {
    access.stop_here_if_asked();
    const std::vector<double> q = physics.grasp->target(physics.n_steps++, physics.world->state());
    std::vector<double> followed = q;
    for (std::size_t j = 0; j < target.disturbance.size(); ++j) followed[j] += target.disturbance[j];
    const StepReport report = physics.world->step(followed);
    access.write(steps).push_back({q, target.disturbance, target.element, physics.world->state(), report});
  }
  if (physics.n_steps == physics.n_steps_planned) physics.world.reset();
}

void map(const Access& access) {
  Shown& seen = access.write(shown);
  seen.frame = std::uint32_t(access.frame());
  for (const StepRecord& step : access.read(steps)) seen.motion.push_back(step.state);
  seen.state = seen.motion.back();
}

void judge(const Access& access) {
  JudgeState& state = access.write(verdict);
  SolverTotals& totals = state.totals;
  for (const StepRecord& step : access.read(steps)) {
    state.monitor->observe(step.state, state.phase.at(state.n_steps++));
    const StepReport& report = step.report;
    totals.min_gap = totals.steps == 0 ? report.min_gap : std::min(totals.min_gap, report.min_gap);
    ++totals.steps;
    totals.newton += report.newton;
    totals.cg += report.cg;
    totals.retries += report.retries;
    totals.most_newton = std::max(totals.most_newton, report.newton);
    totals.most_contacts = std::max(totals.most_contacts, report.contacts);
    totals.residual = std::max(totals.residual, report.residual);
  }
}

void record(const Access& access) {
  RecordState& state = access.write(recording);
  state.recorder->append_steps(access.read(steps));
  state.recorder->append_frame(access.read(images));
  state.advance(access.frame() + 1);
}

// ---- an episode -------------------------------------------------------------------------------------------------

namespace {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

RecordSettings record_settings(const Task& task, const TaskScene& built, const EpisodeSettings& settings,
                               const Device& physics, const Device& rendering, std::size_t n_frames,
                               const std::vector<bool>& records_mask) {
  RecordSettings record;
  record.header.task = task.name;
  record.header.seed = settings.seed;
  record.header.episode = settings.episode;
  record.header.configuration = resolved_yaml(task, built);
  record.header.states = task.record.states;
  record.header.is_disturbed = !built.disturbances.empty();
  record.header.versions = versions(physics, rendering, settings.renders && task.render.denoise);
  for (const SampledValue& sampled : built.sampled) record.header.sampled.emplace_back(sampled.name, sampled.value);
  for (const ObjectSection& object : task.objects) record.header.objects.push_back(object.name);
  record.frames_per_second = task.render.frames_per_second;
  record.n_frames = n_frames;
  record.records_mask = records_mask;
  for (const MotionElement& element : task.motion) record.elements.push_back(kind_of(element).name);
  record.renders = settings.renders;
  return record;
}

std::vector<bool> masks_asked(const Task& task, const Scene& scene) {
  std::vector<bool> asked;
  for (const Camera& camera : scene.cameras)
    asked.push_back(std::any_of(task.cameras.begin(), task.cameras.end(), [&](const CameraSection& section) {
      return section.name == camera.name && section.records_gripper_mask;
    }));
  return asked;
}

std::vector<MeshSize> mesh_sizes(const Scene& scene) {
  std::vector<MeshSize> sizes;
  for (const SoftBody& body : scene.soft_bodies)
    sizes.push_back({body.name, body.mesh.points.size(), body.mesh.n_elements(), body.mesh.surface.size()});
  for (const Cloth& cloth : scene.cloths)
    sizes.push_back({cloth.name, cloth.mesh.points.size(), 0, cloth.mesh.triangles.size()});
  for (const RigidBody& body : scene.rigid_bodies)
    if (!body.collision.triangles.empty())
      sizes.push_back({body.name, body.collision.points.size(), 0, body.collision.triangles.size()});
  return sizes;
}

// A step that could not be done ends the episode, not the program; everything else goes on up.
std::string reason_of_failed_step(const StageError& error) {
  try {
    std::rethrow_exception(error.cause);
  } catch (const StepFailure& failure) {
    return failure.what();
  } catch (const UsageError& usage) {
    throw UsageError(error.what());
  } catch (...) {
    throw error;
  }
}

// The scene at its start; what is wrong with it is wrong in the task's file.
std::unique_ptr<SharedSimulation::World> start_world(const Task& task, const Scene& scene, SharedSimulation& shared) {
  try {
    return shared.join(scene);
  } catch (const DeviceError&) {
    throw;
  } catch (const UsageError& error) {
    throw UsageError(task.file.string() + ": " + error.what());
  }
}

}  // namespace

// spread over 64 bits (splitmix64)
std::uint64_t picture_seed(std::uint64_t seed, std::uint64_t episode) {
  return mixed_bits(seed + 0x9e3779b97f4a7c15u * episode);
}

RenderSettings picture_settings(const Task& task, std::uint64_t seed, std::uint64_t episode) {
  RenderSettings settings = settings_of(task.render);
  settings.seed = picture_seed(seed, episode);
  return settings;
}

void apply(const PictureOverrides& overrides, Task& task) {
  for (CameraSection& camera : task.cameras) {
    if (overrides.width) camera.width = overrides.width;
    if (overrides.height) camera.height = overrides.height;
  }
  if (overrides.samples) task.render.samples = overrides.samples;
  if (overrides.frames_per_second > 0) task.render.frames_per_second = overrides.frames_per_second;
}

void check_no_pictures(const PictureOverrides& overrides, const std::string& render_device) {
  const auto refuse = [](bool is_given, const char* option) {
    if (is_given)
      throw UsageError(std::string("--no-render makes no pictures, for which ") + option + " is; give one of the two");
  };
  refuse(overrides.width > 0, "--width");
  refuse(overrides.height > 0, "--height");
  refuse(overrides.samples > 0, "--samples");
  refuse(!render_device.empty(), "--render-device");
}

void make_grippers_rigid(Task& task) {
  if (task.gripper) task.gripper->is_rigid = true;
  for (RobotCell& robot : task.more_robots)
    if (robot.gripper) robot.gripper->is_rigid = true;
}

bool shows(const EpisodeSettings& settings, const std::string& camera) {
  return settings.cameras.empty() ||
         std::find(settings.cameras.begin(), settings.cameras.end(), camera) != settings.cameras.end();
}

EpisodeReport run_episode(const Task& task, const EpisodeSettings& settings, EpisodeDevices& devices,
                          const std::filesystem::path& folder, const std::atomic<bool>& stop,
                          const std::function<void(std::size_t, std::size_t)>& advance) {
  SharedSimulation& simulation = devices.simulations.at(settings.simulation);
  Device &physics = simulation.device(), &rendering = devices.rendering;
  EpisodeReport report;
  const Stopwatch build_watch;
  TaskScene built = build_scene(task, settings.seed, settings.episode);
  // after all draws, which are those of the whole task
  std::erase_if(built.scene.cameras, [&](const Camera& camera) { return !shows(settings, camera.name); });
  const Scene& scene = built.scene;
  report.time_step = scene.solver.time_step;
  report.frames_per_second = task.render.frames_per_second;
  report.meshes = mesh_sizes(scene);
  report.device = physics.info().name;
  report.render_device = rendering.info().name;
  if (settings.renders && task.render.denoise) report.denoiser = denoiser_name(rendering);
  report.seconds.emplace_back("build", build_watch.seconds());

  const Table table = episode_table();
  Store store(table, settings.frames_under_way);
  const Stopwatch start_watch;
  try {
    store.state(motion) = plan_episode(task, built);
    store.state(world).world = start_world(task, scene, simulation);
  } catch (const DeviceError&) {
    throw;
  } catch (const UsageError& error) {  // out of reach, or an initial intersection: this draw of the start is no good
    report.reason = error.what();
    return report;
  }
  const MotionPlan& whole = store.state(motion);
  store.state(world).grasp = std::make_unique<ForceGrasp>(whole);
  store.state(world).n_steps_planned = whole.targets.size();
  const std::size_t n_frames = whole.targets.size() / whole.steps_per_frame;
  const std::vector<bool> records_mask = masks_asked(task, scene);
  FramePictures at_start;
  if (settings.renders) {
    store.state(fields::renderer).turn = &devices.rendering_turn;
    std::optional<Lut> lut;
    if (!task.render.lut.empty()) lut = read_lut(task.render.lut);
    const std::lock_guard turn(devices.rendering_turn);
    auto renderer =
        std::make_unique<Renderer>(rendering, scene, picture_settings(task, settings.seed, settings.episode));
    at_start = pictures_at_rest(*renderer, scene.cameras.size(), store.state(world).world->state(), START_FRAME, lut);
    start_pictures(store, std::move(renderer), std::move(lut), records_mask);
  }
  JudgeState& judge_state = store.state(verdict);
  judge_state.monitor =
      std::make_unique<SuccessMonitor>(task, scene, hands_of(built), store.state(world).world->state());
  judge_state.phase = phases(task.motion, whole.element, int(built.robots.size()));
  RecordState& record_state = store.state(recording);
  record_state.recorder = std::make_unique<EpisodeRecorder>(
      folder, scene, record_settings(task, built, settings, physics, rendering, n_frames, records_mask),
      disabled_pairs(scene));
  record_state.recorder->write_start(store.state(world).world->state(), at_start);
  record_state.advance = [&](std::size_t done) {
    report.n_frames = done;
    advance(done, n_frames);
  };
  report.seconds.emplace_back("start", start_watch.seconds());

  advance(0, n_frames);
  const Stopwatch stream_watch;
  try {
    const std::vector<double> seconds = stream(table, store, n_frames, stop);
    for (std::size_t i = 0; i < table.size(); ++i) report.seconds.emplace_back(table[i].name, seconds[i]);
  } catch (const StageError& error) {
    report.reason = reason_of_failed_step(error);
  }
  record_state.recorder->finish();
  report.seconds.emplace_back("all_stages", stream_watch.seconds());
  report.measured = judge_state.monitor->measured();
  report.solver = judge_state.totals;
  if (report.reason.empty()) report.reason = judge_state.monitor->failure().value_or("");
  report.has_succeeded = report.reason.empty();
  return report;
}

}  // namespace pvg
