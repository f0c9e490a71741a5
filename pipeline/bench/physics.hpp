// Benchmarks of the simulator on named scenes: what a step costs and where its time goes.
#pragma once
#include <atomic>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/device/command_times.hpp"
#include "host/device/device.hpp"
#include "host/model/scene.hpp"
#include "host/physics/step/phase_clock.hpp"

namespace pvg {

struct PhysicsBenchmark {
  std::string name;
  std::string file;          // relative to data/
  std::size_t n_worlds = 1;  // copies of the scene in one solve
  double duration = 0;       // of motion [s]; 0: all that the file says
  std::string what;
};

struct PhysicsFigures {
  std::string name;
  std::size_t vertices = 0, tetrahedra = 0, worlds = 1, steps = 0;  // of one world
  double time_step = 0;                                             // [s]
  double seconds_per_step = 0;                                      // all worlds together; median over the repeats
  double cpu_seconds_per_step = 0;                                  // of all threads; the same run
  double newton_per_step = 0, cg_per_newton = 0;                    // means over steps and worlds
  double contacts = 0;                                              // mean over steps, all worlds
  PhaseSeconds phases{};                                            // per step, of a further run [s]
  double other = 0;                                                 // the rest of a step in that run [s]
  double bytes_moved = 0;                                           // between host and device, per step
  std::size_t peak_bytes = 0;                                       // of the process, above what it had before
  std::size_t device_bytes = 0;                                     // of its buffers
};

struct PhysicsCounts {
  std::string name;
  std::size_t worlds = 1, steps = 0;
  bool runs_host_functions = false;  // the device: nothing moves for the factor on the host then
  SolverCounts counts;               // of all steps
  DeviceCountsByName by_name;        // of all steps, recording included
};

struct PhysicsCommands {
  std::string name;
  std::size_t worlds = 1, steps = 0;
  double seconds = 0;  // by the clock, of all steps, each command with its event
  long long newton = 0;
  std::map<std::string, CommandTime> commands;  // of all steps
};

std::vector<PhysicsBenchmark> physics_benchmarks();
// Those with these names, all of them for none; throws a UsageError that lists them where there is no such one.
std::vector<PhysicsBenchmark> physics_benchmarks(const std::vector<std::string>& names);

// A scene and what its drives are told at each step.
struct BenchmarkRun {
  Scene scene;
  std::vector<std::vector<double>> targets;  // [n_steps][n_driven]
};
BenchmarkRun load_run(const PhysicsBenchmark& benchmark, const std::filesystem::path& data);

// Runs the first `most_steps` steps of one benchmark `repeats` times after a warm-up of two steps. data: the folder
// that holds bench/ and tasks/. preconditioner: instead of the scene's. Throws TryAgain where `stop` asks for it.
PhysicsFigures run_physics_benchmark(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                                     const std::string& device, std::size_t repeats, std::size_t most_steps,
                                     const std::atomic<bool>& stop,
                                     std::optional<SolverSettings::Preconditioner> preconditioner = {});

// What these steps ask of the device.
PhysicsCounts count_physics_benchmark(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                                      const std::string& device, std::size_t most_steps, const std::atomic<bool>& stop,
                                      std::optional<SolverSettings::Preconditioner> preconditioner = {});

// How long the device is at work on what, in the same steps.
PhysicsCommands time_commands_of_benchmark(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                                           const std::string& device, std::size_t most_steps,
                                           const std::atomic<bool>& stop,
                                           std::optional<SolverSettings::Preconditioner> preconditioner = {});

// What these launches, waits and transfers would cost on a discrete GPU beside its computing [s]: a model, not
// measured.
double modelled_seconds(const DeviceCounts& counts);

}  // namespace pvg
