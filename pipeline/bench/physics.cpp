#include "pipeline/bench/physics.hpp"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <numeric>

#include "host/load/build_scene.hpp"
#include "host/load/scene_file.hpp"
#include "host/load/task_file.hpp"
#include "host/physics/step/simulation.hpp"
#include "pipeline/episode/motion_plan.hpp"

namespace pvg {
namespace {

constexpr std::size_t N_WARM_UP = 2;  // steps; kernels are compiled in them

// Peak resident memory since it was last reset [bytes]; 0 where the system does not tell.
std::size_t peak_resident_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      std::size_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  return 0;
}

void reset_peak_resident_bytes() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

struct Repeat {
  double seconds = 0, cpu_seconds = 0;
  long long newton = 0, cg = 0, contacts = 0;
  PhaseSeconds phases{};
  SolverCounts counts;
  DeviceCountsByName by_name;
  std::map<std::string, CommandTime> commands;
};

enum class Measure { times, phases, counts, commands };

Repeat repeat(Device& device, const BenchmarkRun& run, std::size_t n_worlds, Measure measure,
              const std::atomic<bool>& stop) {
  const std::vector<PhysicalScene> scenes(n_worlds, run.scene);
  Simulation simulation(device, scenes);
  const auto step = [&](std::size_t i) {
    const std::vector<std::vector<double>> targets(n_worlds, run.targets[i]);
    return simulation.step(targets);
  };
  const Checkpoint start = simulation.checkpoint();
  for (std::size_t i = 0; i < std::min(N_WARM_UP, run.targets.size()); ++i) step(i);
  simulation.restore(start);
  if (measure == Measure::phases) simulation.measure_phases();
  if (measure == Measure::counts) device.count_by_name();
  if (measure == Measure::commands) time_commands(device);
  Repeat result;
  simulation.restart_counts();
  const std::clock_t cpu_begin = std::clock();
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < run.targets.size(); ++i) {
    if (stop) throw TryAgain("stopped; nothing was measured");
    for (const StepReport& report : step(i)) {
      result.newton += report.newton;
      result.cg += report.cg;
      result.contacts += report.contacts;
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.cpu_seconds = double(std::clock() - cpu_begin) / CLOCKS_PER_SEC;
  result.counts = simulation.counts();
  result.by_name = device.counts_by_name();
  if (measure == Measure::commands) result.commands = take_command_times(device);
  result.phases = simulation.phase_seconds();
  return result;
}

}  // namespace

std::vector<PhysicsBenchmark> physics_benchmarks() {
  return {
      {"mat_twist", "bench/mat_twist.yaml", 1, 0, "a mat of 3,200 points twisted, 73 steps of 40 ms"},
      {"sphere_on_mat", "bench/sphere_on_mat.yaml", 1, 0, "a soft ball falls on a soft mat"},
      {"towel", "bench/towel.yaml", 1, 0, "a towel of 961 points is lifted by a corner and folded"},
      {"weigh_beaker", "tasks/weigh_beaker.yaml", 1, 0, "the task Weigh Beaker without pictures"},
      {"weigh_beaker_16", "tasks/weigh_beaker.yaml", 16, 0, "the same 16 times in one solve"},
      {"two_arms_towel", "bench/two_arms_towel.yaml", 1, 0, "two arms, two soft grippers, a large towel"},
      {"small_grasp", "bench/small_grasp.yaml", 1, 0, "two pads grasp a cube"},
      {"small_grasp_4", "bench/small_grasp.yaml", 4, 0, "the same four times in one solve"},
      {"small_grasp_16", "bench/small_grasp.yaml", 16, 0, "16 times"},
      {"small_grasp_64", "bench/small_grasp.yaml", 64, 0, "64 times"},
      {"block_1k", "bench/block_1k.yaml", 1, 0, "a block of 1,080 tetrahedra is pressed on a table"},
      {"block_4k", "bench/block_4k.yaml", 1, 0, "3,888 tetrahedra"},
      {"block_16k", "bench/block_16k.yaml", 1, 0, "16,464 tetrahedra"},
      {"block_64k", "bench/block_64k.yaml", 1, 0, "63,888 tetrahedra"},
  };
}

std::vector<PhysicsBenchmark> physics_benchmarks(const std::vector<std::string>& names) {
  if (names.empty()) return physics_benchmarks();
  std::vector<PhysicsBenchmark> benchmarks;
  std::string known;
  for (const PhysicsBenchmark& each : physics_benchmarks()) known += (known.empty() ? "" : ", ") + each.name;
  for (const std::string& name : names) {
    const std::size_t before = benchmarks.size();
    for (const PhysicsBenchmark& each : physics_benchmarks())
      if (each.name == name) benchmarks.push_back(each);
    if (benchmarks.size() == before)
      throw UsageError("--scene " + name + ": there is no such benchmark; there are: " + known);
  }
  return benchmarks;
}

BenchmarkRun load_run(const PhysicsBenchmark& benchmark, const std::filesystem::path& data) {
  BenchmarkRun run;
  const std::filesystem::path file = data / benchmark.file;
  if (benchmark.file.starts_with("tasks/")) {
    const Task task = load_task(file);
    const TaskScene built = build_scene_at_middle(task);
    run.scene = built.scene;
    run.targets = plan_episode(task, built).targets;
  } else {
    const SceneRun scene = load_scene_run(file);
    run.scene = scene.scene;
    for (std::size_t step = 1; step <= scene.n_steps(); ++step)
      run.targets.push_back(scene.targets_at(double(step) * scene.scene.solver.time_step));
  }
  if (benchmark.duration > 0)
    run.targets.resize(
        std::min(run.targets.size(), std::size_t(benchmark.duration / run.scene.solver.time_step + 0.5)));
  return run;
}

namespace {

// a run of at most so many steps of a benchmark
struct MeasuredSteps {
  Repeat run;
  std::size_t steps = 0;
  bool runs_host_functions = false;  // the device
};

MeasuredSteps measure_steps(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                            const std::string& device_name, std::size_t most_steps, const std::atomic<bool>& stop,
                            std::optional<SolverSettings::Preconditioner> preconditioner, Measure measure) {
  BenchmarkRun run = load_run(benchmark, data);
  if (preconditioner) run.scene.solver.preconditioner = *preconditioner;
  run.targets.resize(std::min(run.targets.size(), most_steps));
  Device device(device_name);
  return {repeat(device, run, benchmark.n_worlds, measure, stop), run.targets.size(),
          device.info().runs_host_functions};
}

}  // namespace

PhysicsCounts count_physics_benchmark(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                                      const std::string& device, std::size_t most_steps, const std::atomic<bool>& stop,
                                      std::optional<SolverSettings::Preconditioner> preconditioner) {
  const MeasuredSteps m = measure_steps(benchmark, data, device, most_steps, stop, preconditioner, Measure::counts);
  return {benchmark.name, benchmark.n_worlds, m.steps, m.runs_host_functions, m.run.counts, m.run.by_name};
}

PhysicsCommands time_commands_of_benchmark(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                                           const std::string& device, std::size_t most_steps,
                                           const std::atomic<bool>& stop,
                                           std::optional<SolverSettings::Preconditioner> preconditioner) {
  const MeasuredSteps m = measure_steps(benchmark, data, device, most_steps, stop, preconditioner, Measure::commands);
  return {benchmark.name, benchmark.n_worlds, m.steps, m.run.seconds, m.run.newton, m.run.commands};
}

double modelled_seconds(const DeviceCounts& counts) {
  constexpr double LAUNCH = 7e-6, WAIT = 15e-6;  // [s] of a discrete GPU, from the host's call to its effect
  constexpr double BYTES_PER_SECOND = 10e9;      // between host and device
  return LAUNCH * double(counts.launches + counts.writes) + WAIT * double(counts.waits) +
         double(counts.bytes) / BYTES_PER_SECOND;
}

PhysicsFigures run_physics_benchmark(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                                     const std::string& device_name, std::size_t repeats, std::size_t most_steps,
                                     const std::atomic<bool>& stop,
                                     std::optional<SolverSettings::Preconditioner> preconditioner) {
  reset_peak_resident_bytes();
  const std::size_t before = peak_resident_bytes();
  BenchmarkRun run = load_run(benchmark, data);
  if (preconditioner) run.scene.solver.preconditioner = *preconditioner;
  run.targets.resize(std::min(run.targets.size(), most_steps));
  Device device(device_name);
  std::vector<Repeat> results;
  for (std::size_t i = 0; i < repeats; ++i)
    results.push_back(repeat(device, run, benchmark.n_worlds, Measure::times, stop));
  // waiting after each phase takes time, so phases have a run of their own
  const Repeat by_phase = repeat(device, run, benchmark.n_worlds, Measure::phases, stop);
  std::sort(results.begin(), results.end(), [](const Repeat& a, const Repeat& b) { return a.seconds < b.seconds; });
  const Repeat& median = results[results.size() / 2];
  const double n_steps = double(run.targets.size());

  PhysicsFigures figures;
  figures.name = benchmark.name;
  for (const SoftBody& body : run.scene.soft_bodies) {
    figures.vertices += body.mesh.points.size();
    figures.tetrahedra += body.mesh.n_elements();
  }
  for (const Cloth& cloth : run.scene.cloths) figures.vertices += cloth.mesh.points.size();
  figures.worlds = benchmark.n_worlds;
  figures.steps = run.targets.size();
  figures.time_step = run.scene.solver.time_step;
  figures.seconds_per_step = median.seconds / n_steps;
  figures.cpu_seconds_per_step = median.cpu_seconds / n_steps;
  figures.newton_per_step = double(median.newton) / n_steps / double(benchmark.n_worlds);
  figures.cg_per_newton = double(median.cg) / double(std::max(1LL, median.newton));
  figures.contacts = double(median.contacts) / n_steps;
  for (std::size_t phase = 0; phase < N_PHASES; ++phase) figures.phases[phase] = by_phase.phases[phase] / n_steps;
  figures.other = by_phase.seconds / n_steps - std::accumulate(figures.phases.begin(), figures.phases.end(), 0.0);
  figures.bytes_moved = double(median.counts.all.bytes) / n_steps;
  figures.peak_bytes = peak_resident_bytes() - before;
  figures.device_bytes = device.peak_bytes();
  return figures;
}

}  // namespace pvg
