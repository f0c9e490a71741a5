// phyvisgen bench physics: what a step costs on named scenes.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/stop_signal.hpp"
#include "pipeline/bench/physics.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/data_folder.hpp"

namespace pvg {
namespace {

struct BenchPhysicsOptions {
  std::vector<std::string> scenes;  // names; empty: all
  std::string device;
  std::size_t repeats = 3;
  bool as_json = false;
  bool counts = false;    // print what is asked of the device, instead of times
  bool commands = false;  // print how long the device is at work on what, instead of times
  std::size_t steps = ~std::size_t(0);
  bool lists = false;          // print the names and nothing else
  std::string preconditioner;  // instead of the scenes' own; empty: those
};

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

void print_counts(const PhysicsCounts& c) {
  const SolverCounts& n = c.counts;
  const DeviceCounts solving = n.all - n.recording;
  const auto print = [&](const char* what, const DeviceCounts& d, std::size_t of) {
    const double by = 1.0 / double(std::max<std::size_t>(1, of));
    std::printf("  %-34s %9.1f %8.1f %8.2f %12.4f %9.3f\n", what, double(d.launches) * by, double(d.writes) * by,
                double(d.waits) * by, 1e-6 * double(d.bytes) * by, 1e3 * modelled_seconds(d) * by);
  };
  std::printf("%s, %s, %s, %.2f Newton and %.2f CG iterations a step\n", c.name.c_str(),
              counted(c.worlds, "world").c_str(), counted(c.steps, "step").c_str(), double(n.newton) / double(c.steps),
              double(n.cg) / double(c.steps));
  if (n.repeated_guesses > 0)
    std::printf("  %s did not come as foreseen and were started again\n",
                counted(n.repeated_guesses, "first guess", "first guesses").c_str());
  std::printf(c.runs_host_functions
                  ? "  a device that runs host functions: the factor on the host moves nothing (PVG_HOST_FUNCTIONS=0: "
                    "like a device apart)\n"
                  : "  a device apart from the host\n");
  std::printf("  %-34s %9s %8s %8s %12s %9s\n", "", "launches", "writes", "waits", "MB moved", "model ms");
  print("a step, without recording", solving, c.steps);
  print("recording, a step", n.recording, c.steps);
  print("a Newton iteration", solving, n.newton);
  print("a CG iteration, with its start", n.phases[std::size_t(SolverPhase::solve)], n.cg);
  for (std::size_t phase = 0; phase < N_PHASES; ++phase) print(PHASE_NAMES[phase], n.phases[phase], n.newton);
  std::vector<std::pair<std::size_t, std::string>> most_first;
  for (const auto& [name, times] : c.by_name) most_first.push_back({times, name});
  std::sort(most_first.rbegin(), most_first.rend());
  std::printf("  what was asked for, times a step, recording included\n");
  for (const auto& [times, name] : most_first)
    std::printf("  %9.1f  %s\n", double(times) / double(c.steps), name.c_str());
  std::fflush(stdout);
}

void print_commands(const PhysicsCommands& c) {
  double busy = 0;
  std::vector<std::pair<double, std::string>> longest_first;
  for (const auto& [name, time] : c.commands) {
    busy += time.seconds;
    longest_first.push_back({time.seconds, name});
  }
  std::sort(longest_first.rbegin(), longest_first.rend());
  const double by = 1.0 / double(c.steps);
  std::printf("%s, %s, %s of %.2f Newton iterations: %.3f ms a step, the device at work for %.3f ms\n", c.name.c_str(),
              counted(c.worlds, "world").c_str(), counted(c.steps, "step").c_str(),
              double(c.newton) * by / double(c.worlds), 1e3 * c.seconds * by, 1e3 * busy * by);
  std::printf("  %9s %9s %9s\n", "ms a step", "times", "us each");
  for (const auto& [seconds, name] : longest_first) {
    const double times = double(c.commands.at(name).times);
    std::printf("  %9.4f %9.2f %9.2f  %s\n", 1e3 * seconds * by, times * by, 1e6 * seconds / times, name.c_str());
  }
  std::fflush(stdout);
}

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
  if (options.counts) {
    for (const PhysicsBenchmark& each : benchmarks)
      print_counts(count_physics_benchmark(each, data_folder(), options.device, options.steps, stop_on_signals(),
                                           preconditioner));
    return;
  }
  if (options.commands) {
    for (const PhysicsBenchmark& each : benchmarks)
      print_commands(time_commands_of_benchmark(each, data_folder(), options.device, options.steps, stop_on_signals(),
                                                preconditioner));
    return;
  }
  nlohmann::ordered_json out = {{"schema", 1}, {"device", Device(options.device).info().name}};
  out["scenes"] = nlohmann::ordered_json::array();
  if (!options.as_json) print_head();
  for (const PhysicsBenchmark& each : benchmarks) {
    const PhysicsFigures figures = run_physics_benchmark(each, data_folder(), options.device, options.repeats,
                                                         options.steps, stop_on_signals(), preconditioner);
    if (options.as_json)
      out["scenes"].push_back(json_of(figures));
    else
      print_row(figures);
  }
  if (options.as_json) std::printf("%s\n", out.dump(2).c_str());
}

}  // namespace

void add_bench_physics(CLI::App& program) {
  CLI::App* command = command_group(program, "bench").add_subcommand("physics", "Time the simulator on named scenes");
  BenchPhysicsOptions& o = options_of_command(*command, run_bench_physics);
  command->add_option("--scene", o.scenes, "Only this scene; may stand several times")->allow_extra_args(false);
  command->add_option("--repeats", o.repeats, "Runs of each scene; the median is printed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_option("--preconditioner", o.preconditioner, "Instead of what the scenes say")
      ->check(CLI::IsMember({"automatic", "factor", "schwarz", "block_jacobi"}));
  command->add_flag("--count", o.counts,
                    "Print launches, waits and bytes moved, and what they would cost on a discrete GPU");
  command->add_flag("--commands", o.commands, "Print how long the device is at work on each kernel, read and write")
      ->excludes("--count");
  command->add_option("--steps", o.steps, "At most this many steps of a scene")->check(CLI::PositiveNumber);
  command->add_flag("--list", o.lists, "Print the names of the scenes and end");
  command->add_flag("--json", o.as_json, "Print JSON")->excludes("--commands");
  command->footer(
      "Examples:\n  phyvisgen bench physics --scene mat_twist --scene towel --repeats 1\n"
      "  phyvisgen bench physics --scene block_64k --preconditioner schwarz\n"
      "  phyvisgen bench physics --scene weigh_beaker --count --steps 100\n"
      "  phyvisgen bench physics --scene weigh_beaker --commands --steps 20");
}

}  // namespace pvg
