#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/base/stop_signal.hpp"
#include "pipeline/bench/physics.hpp"
#include "pipeline/commands/commands.hpp"
#include "pipeline/commands/data_folder.hpp"

namespace pvg {
namespace {

nlohmann::ordered_json json_of(const PhysicsFigures& figures) {
  nlohmann::ordered_json phases;
  for (std::size_t phase = 0; phase < N_PHASES; ++phase) phases[PHASE_NAMES[phase]] = figures.phases[phase];
  phases["other"] = figures.other;
  return {{"name", figures.name},
          {"vertices", figures.vertices},
          {"tetrahedra", figures.tetrahedra},
          {"worlds", figures.worlds},
          {"steps", figures.steps},
          {"time_step", figures.time_step},
          {"seconds_per_step", figures.seconds_per_step},
          {"cpu_seconds_per_step", figures.cpu_seconds_per_step},
          {"newton_per_step", figures.newton_per_step},
          {"cg_per_newton", figures.cg_per_newton},
          {"phases", phases},
          {"contacts", figures.contacts},
          {"bytes_moved", figures.bytes_moved},
          {"peak_bytes", figures.peak_bytes},
          {"device_bytes", figures.device_bytes}};
}

void print_head() {
  std::printf("%-16s %8s %8s %6s %9s %9s %7s %6s %8s %8s | ms per step:", "scene", "vertices", "tets", "worlds",
              "ms/step", "cpu ms", "newton", "cg/it", "contacts", "peak MB");
  for (const char* phase : {"broad", "narrow", "assembl", "precond", "solve", "ccd", "search", "other"})
    std::printf(" %7s", phase);
  std::printf("\n");
}

void print_row(const PhysicsFigures& f) {
  std::printf("%-16s %8zu %8zu %6zu %9.2f %9.2f %7.2f %6.1f %8.0f %8.0f |             ", f.name.c_str(), f.vertices,
              f.tetrahedra, f.worlds, 1e3 * f.seconds_per_step, 1e3 * f.cpu_seconds_per_step, f.newton_per_step,
              f.cg_per_newton, f.contacts, double(f.peak_bytes) / 1e6);
  for (const double seconds : f.phases) std::printf(" %7.2f", 1e3 * seconds);
  std::printf(" %7.2f\n", 1e3 * f.other);
  std::fflush(stdout);
}

}  // namespace

void run_bench_physics(const BenchPhysicsOptions& options) {
  const std::vector<PhysicsBenchmark> benchmarks = physics_benchmarks(options.scenes);
  if (options.lists) {
    for (const PhysicsBenchmark& each : benchmarks) std::printf("%-16s %s\n", each.name.c_str(), each.what.c_str());
    return;
  }
  std::optional<SolverSettings::Preconditioner> preconditioner;
  if (!options.preconditioner.empty())
    preconditioner = SolverSettings::Preconditioner(
        std::find(PRECONDITIONER_NAMES.begin(), PRECONDITIONER_NAMES.end(), options.preconditioner) -
        PRECONDITIONER_NAMES.begin());
  nlohmann::ordered_json out = {{"schema", 1}, {"device", Device(options.device).info().name}};
  out["scenes"] = nlohmann::ordered_json::array();
  if (!options.as_json) print_head();
  for (const PhysicsBenchmark& each : benchmarks) {
    const PhysicsFigures figures =
        run_physics_benchmark(each, data_folder(), options.device, options.repeats, stop_on_signals(), preconditioner);
    if (options.as_json)
      out["scenes"].push_back(json_of(figures));
    else
      print_row(figures);
  }
  if (options.as_json) std::printf("%s\n", out.dump(2).c_str());
}

}  // namespace pvg
