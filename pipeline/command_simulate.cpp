#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/base/progress.hpp"
#include "host/io/states_file.hpp"
#include "host/scene/scene_file.hpp"
#include "pipeline/commands.hpp"
#include "pipeline/disabled_pairs.hpp"
#include "pipeline/stop_signal.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

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
  header.versions = versions(device);
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
  std::fprintf(stderr, "  t = %.6g s: %d Newton, %d cg, %d contacts, smallest gap %.3g m, last correction %.2g m/s%s\n",
               time, report.newton, report.cg, report.contacts, report.min_gap, report.residual,
               report.retries > 0 ? (", " + std::to_string(report.retries) + " retries").c_str() : "");
}

}  // namespace

void run_simulate(const SimulateOptions& options) {
  if (options.scene.empty())
    throw UsageError("simulate needs a scene file; `phyvisgen simulate --help` shows an example");
  if (options.file.empty()) throw UsageError("simulate needs an output file: -o FILE.h5");
  const std::atomic<bool>& stop = stop_on_signals();
  SceneRun run = load_scene_run(options.scene);
  if (options.duration >= 0) run.duration = options.duration;
  const std::size_t n = run.n_steps();
  if (n == 0)
    throw UsageError(options.scene + ": the duration is shorter than half a time step; there is nothing to do");
  Device device(options.device);
  Simulation simulation(device, run.scene);

  const fs::path file = fs::absolute(options.file),
                 partial =
                     file.parent_path() / ("." + file.filename().string() + ".partial-" + std::to_string(getpid()));
  Totals totals;
  try {
    StatesFile states(partial, run.scene, header_of(run, device), disabled_pairs(run.scene));
    Progress progress(run.scene.name, "steps", n);
    for (std::size_t step = 1; step <= n; ++step) {
      if (stop)
        throw TryAgain("stopped after " + std::to_string(totals.steps) + " of " + std::to_string(n) +
                       " steps; no file was written");
      const std::vector<double> targets = run.targets_at(double(step) * run.scene.solver.time_step);
      const StepReport report = simulation.step(targets);
      states.append_step(simulation.state(), report, targets);
      totals.add(report);
      progress.advance_to(step);
      if (options.is_verbose) explain(report, simulation.state().time);
    }
    states.close();
  } catch (...) {
    std::error_code ignored;
    fs::remove(partial, ignored);
    throw;
  }
  fs::rename(partial, file);
  if (options.as_json)
    print_json(options, run, totals);
  else
    std::printf("%s: %zu steps, %.1f Newton iterations per step\n", options.file.c_str(), totals.steps,
                double(totals.newton) / double(totals.steps));
}

}  // namespace pvg
