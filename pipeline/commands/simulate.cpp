// phyvisgen simulate: a scene file to states.h5. Checkpoints are written to FILE.checkpoint.h5, each over the one
// before; after a step that failed, FILE holds what there is and the checkpoint the last state that was well.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/base/progress.hpp"
#include "host/base/stop_signal.hpp"
#include "host/dataset/animation_file.hpp"
#include "host/dataset/checkpoint_file.hpp"
#include "host/dataset/states_file.hpp"
#include "host/load/scene_file.hpp"
#include "host/physics/step/separate_bodies.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/episode/disabled_pairs.hpp"
#include "pipeline/episode/episode.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct SimulateOptions {
  std::string scene, file;          // scene file, states file
  double duration = -1;             // [s]; negative: what the scene says
  std::string resume;               // checkpoint to go on from; empty: from the start
  double checkpoint_every = 0;      // simulated time between checkpoints [s]; 0: none
  std::string animation;            // binary glTF to write as well; empty: none
  double pictures_per_second = 25;  // of the animation
  std::string device;
  bool as_json = false, is_verbose = false;
};

struct Totals {
  std::size_t steps = 0;
  long long newton = 0, cg = 0, retries = 0;
  int most_newton = 0, most_contacts = 0;
  double min_gap = std::numeric_limits<double>::infinity();

  void add(const StepReport& report) {
    ++steps;
    newton += report.newton;
    cg += report.cg;
    retries += report.retries;
    most_newton = std::max(most_newton, report.newton);
    most_contacts = std::max(most_contacts, report.contacts);
    min_gap = std::min(min_gap, report.min_gap);
  }
};

EpisodeHeader header_of(const SceneRun& run, const Device& device) {
  EpisodeHeader header;
  header.task = run.scene.name;
  header.configuration = run.configuration;
  header.versions = versions(device, device);
  for (const RigidBody& body : run.scene.rigid_bodies) header.objects.push_back(body.name);
  return header;
}

void print_json(const SimulateOptions& options, const SceneRun& run, const Totals& totals) {
  nlohmann::ordered_json out = {{"schema", 1},
                                {"scene", run.scene.name},
                                {"file", options.file},
                                {"time_step", run.scene.solver.time_step},
                                {"steps", totals.steps},
                                {"newton", totals.newton},
                                {"most_newton", totals.most_newton},
                                {"cg", totals.cg},
                                {"retries", totals.retries},
                                {"most_contacts", totals.most_contacts}};
  if (totals.most_contacts > 0) out["min_gap"] = totals.min_gap;
  std::printf("%s\n", out.dump(2).c_str());
}

void explain(const StepReport& report, double time) {
  std::fprintf(stderr, "  t = %.6g s: %d Newton, %d cg, %s, smallest gap %.3g m, last correction %.2g m/s%s\n", time,
               report.newton, report.cg, counted(std::uint64_t(report.contacts), "contact").c_str(), report.min_gap,
               report.residual, report.retries > 0 ? (", " + counted(report.retries, "retry", "retries")).c_str() : "");
}

constexpr std::size_t MOST_STEPS = 1000000000;

// Before anything is computed: no output may cost what is read, or another output.
void check_outputs(const SimulateOptions& options) {
  if (!options.resume.empty()) remember_read(options.resume);
  check_output_file(options.file);
  check_is_not_read(options.file + ".checkpoint.h5");
  if (options.animation.empty()) return;
  check_output_file(options.animation, {".glb"}, "--animation");
  std::error_code ignored;
  if (fs::weakly_canonical(options.animation, ignored) == fs::weakly_canonical(options.file, ignored))
    throw UsageError("--animation " + options.animation + " is the same file as -o; name another");
}

void separate(Scene& scene) {
  if (!scene.separates_start) return;
  for (const Separation& moved : separate_bodies(scene))
    std::fprintf(stderr, "phyvisgen: %s\n", describe(moved).c_str());
}

// What is wrong with the start is wrong in the file.
Simulation begin(Device& device, const Scene& scene, const std::string& file) {
  try {
    return {device, scene};
  } catch (const UsageError& error) {
    throw UsageError(file + ": " + error.what());
  }
}

// Number of steps done already.
std::size_t resume(Simulation& simulation, const SceneRun& run, const std::string& file) {
  if (file.empty()) return 0;
  const SavedCheckpoint saved = read_checkpoint(file);
  if (saved.scene != run.configuration)
    throw UsageError(file + " was made from another text of the scene; resume with the scene file as it was");
  try {
    simulation.restore(saved.checkpoint);
  } catch (const UsageError& error) {
    throw UsageError(file + ": " + error.what());
  }
  return std::size_t(std::llround(simulation.state().time / run.scene.solver.time_step));
}

// Steps `first` + 1 to `last`, each on record; throws StepFailure with what was done on record.
void run_steps(const SimulateOptions& options, const SceneRun& run, Simulation& simulation, std::size_t first,
               std::size_t last, const std::function<void()>& save, StatesFile& states, AnimationFile& animation,
               Totals& totals) {
  const std::atomic<bool>& stop = stop_on_signals();
  const double h = run.scene.solver.time_step;
  const std::size_t every = options.checkpoint_every > 0
                                ? std::max<std::size_t>(1, std::size_t(std::llround(options.checkpoint_every / h)))
                                : 0;
  const std::size_t per_picture =
      std::max<std::size_t>(1, std::size_t(std::llround(1 / (h * options.pictures_per_second))));
  Progress progress(run.scene.name, "steps", last);
  for (std::size_t step = first + 1; step <= last; ++step) {
    if (stop)
      throw TryAgain("stopped after " + std::to_string(totals.steps) + " of " + counted(last - first, "step") +
                     "; no file was written");
    const std::vector<double> targets = run.targets_at(double(step) * h);
    const StepReport report = simulation.step(targets);
    states.append_step(simulation.state(), report, targets);
    totals.add(report);
    if (!options.animation.empty() && (step - first) % per_picture == 0) animation.append(simulation.state());
    if (every > 0 && step % every == 0) save();
    progress.advance_to(step);
    if (options.is_verbose) explain(report, simulation.state().time);
    for (const StepEvent& event : report.events)
      if (options.is_verbose) std::fprintf(stderr, "  retried: %s\n", describe(event, run.scene.name).c_str());
  }
}

void run_simulate(const SimulateOptions& options) {
  if (options.scene.empty())
    throw UsageError("simulate needs a scene file; `phyvisgen simulate --help` shows an example");
  if (options.file.empty()) throw UsageError("simulate needs an output file: -o FILE.h5");
  stop_on_signals();
  SceneRun run = load_scene_run(options.scene);
  if (options.duration >= 0) run.duration = options.duration;
  const std::size_t n = run.n_steps();
  if (n == 0)
    throw UsageError(options.scene + ": the duration is shorter than half a time step; there is nothing to do");
  if (run.duration / run.scene.solver.time_step > double(MOST_STEPS))
    throw UsageError(fmt::format(
        "{}: a duration of {:g} s (--duration {:g}, or `duration`) is more than {} steps; give a shorter one",
        options.scene, run.duration, run.duration, MOST_STEPS));
  check_outputs(options);
  separate(run.scene);
  Device device(options.device);
  Simulation simulation = begin(device, run.scene, options.scene);
  const std::size_t first = resume(simulation, run, options.resume);
  if (first >= n)
    throw UsageError(options.resume + " was made at " + std::to_string(simulation.state().time) +
                     " s, at which the run ends; give a longer --duration");

  const fs::path file = fs::absolute(options.file), saved = file.string() + ".checkpoint.h5";
  PartialFile partial(file);
  const auto save = [&] { write_checkpoint(saved, {simulation.checkpoint(), run.configuration}); };
  Totals totals;
  AnimationFile animation(run.scene);
  animation.append(simulation.state());
  {
    StatesFile states(partial.path(), run.scene, header_of(run, device), disabled_pairs(run.scene));
    try {
      run_steps(options, run, simulation, first, n, save, states, animation, totals);
    } catch (const StepFailure& failure) {
      states.close();
      partial.finish();
      save();
      if (!options.animation.empty()) animation.write(options.animation);
      throw Failure(std::string(failure.what()) + "; " + file.string() + " holds " + counted(totals.steps, "step") +
                    " before it, " + saved.string() + " the last state");
    }
    states.close();
  }
  partial.finish();
  if (!options.animation.empty()) animation.write(options.animation);
  if (options.as_json)
    print_json(options, run, totals);
  else
    std::printf("%s: %s, %.1f Newton iterations per step\n", options.file.c_str(),
                counted(totals.steps, "step").c_str(), double(totals.newton) / double(totals.steps));
}

}  // namespace

void add_simulate(CLI::App& program) {
  CLI::App* command = program.add_subcommand("simulate", "Simulate a scene file and record its states");
  SimulateOptions& o = options_of_command(*command, run_simulate);
  command->add_option("SCENE", o.scene, "Scene file (YAML), or MJCF (.xml), URDF");
  command->add_option("-o,--output", o.file, "States file (HDF5) to write");
  command->add_option("--duration", o.duration, "Simulated time [s]; else what the scene says")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--resume", o.resume,
                      "Checkpoint (HDF5) of the same scene to go on from; FILE holds what follows");
  command
      ->add_option("--checkpoint-every", o.checkpoint_every,
                   "Simulated time [s] after which FILE.checkpoint.h5 is renewed; else only after a failure")
      ->check(CLI::PositiveNumber);
  command->add_option("--animation", o.animation, "Animated binary glTF (.glb) to write as well, for any glTF viewer");
  command->add_option("--pictures-per-second", o.pictures_per_second, "Of the animation; 25 unless given")
      ->check(CLI::Range(0.01, 1000.0));
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print solver statistics as JSON at the end");
  command->add_flag("-v,--verbose", o.is_verbose, "Tell of every step: iterations, contacts, smallest gap");
  command->footer(
      "Examples:\n  phyvisgen simulate data/validation/pendulum.yaml -o pendulum.h5\n"
      "  phyvisgen simulate data/validation/drape.yaml -o drape.h5 --animation drape.glb\n"
      "  phyvisgen simulate data/scenes/two_arms.yaml -o arms.h5 --duration 0.5 --checkpoint-every 0.1\n"
      "  phyvisgen simulate data/scenes/two_arms.yaml -o rest.h5 --resume arms.h5.checkpoint.h5");
}

}  // namespace pvg
