// phyvisgen bench solver: preconditioners and products side by side on one linear system.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/counted.hpp"
#include "host/base/stop_signal.hpp"
#include "pipeline/bench/solver.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/data_folder.hpp"

namespace pvg {
namespace {

struct BenchSolverOptions {
  std::vector<std::string> scenes = {"block_16k"};
  std::string device;
  std::size_t repeats = 3;
  bool as_json = false;
};

nlohmann::ordered_json json_of(const SolverFigures& figures) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const PreconditionerFigures& each : figures.preconditioners)
    rows.push_back({{"name", each.name},
                    {"analyse_seconds", each.analyse_seconds},
                    {"build_seconds", each.build_seconds},
                    {"build_cpu_seconds", each.build_cpu_seconds},
                    {"apply_seconds", each.apply_seconds},
                    {"iterations", each.iterations},
                    {"solve_seconds", each.solve_seconds},
                    {"solve_cpu_seconds", each.solve_cpu_seconds},
                    {"bytes", each.bytes}});
  const ProductFigures& product = figures.product;
  return {{"name", figures.scene},
          {"unknowns", figures.unknowns},
          {"contacts", figures.contacts},
          {"preconditioners", rows},
          {"product",
           {{"assemble_seconds", product.assemble_seconds},
            {"matrix_seconds", product.matrix_seconds},
            {"elements_seconds", product.elements_seconds},
            {"matrix_bytes", product.matrix_bytes},
            {"element_bytes", product.element_bytes}}}};
}

void print(const SolverFigures& figures) {
  std::printf("%s: %s, %s\n", figures.scene.c_str(), counted(figures.unknowns, "unknown").c_str(),
              counted(figures.contacts, "contact").c_str());
  std::printf("  %-22s %11s %9s %9s %9s %6s %9s %9s %9s %8s\n", "preconditioner", "analyse ms", "build ms", "cpu ms",
              "apply ms", "CG", "solve ms", "cpu ms", "total ms", "MB");
  for (const PreconditionerFigures& p : figures.preconditioners)
    std::printf("  %-22s %11.2f %9.2f %9.2f %9.3f %6d %9.2f %9.2f %9.2f %8.2f\n", p.name.c_str(),
                1e3 * p.analyse_seconds, 1e3 * p.build_seconds, 1e3 * p.build_cpu_seconds, 1e3 * p.apply_seconds,
                p.iterations, 1e3 * p.solve_seconds, 1e3 * p.solve_cpu_seconds,
                1e3 * (p.build_seconds + p.solve_seconds), p.bytes / 1e6);
  const ProductFigures& product = figures.product;
  std::printf(
      "  product: assembled matrix %.3f ms (%.2f MB; its assembly %.2f ms), elements' blocks %.3f ms (%.2f MB)\n",
      1e3 * product.matrix_seconds, product.matrix_bytes / 1e6, 1e3 * product.assemble_seconds,
      1e3 * product.elements_seconds, product.element_bytes / 1e6);
  std::fflush(stdout);
}

void run_bench_solver(const BenchSolverOptions& options) {
  nlohmann::ordered_json out = {{"schema", 1}, {"device", Device(options.device).info().name}};
  out["scenes"] = nlohmann::ordered_json::array();
  for (const PhysicsBenchmark& each : physics_benchmarks(options.scenes)) {
    const SolverFigures figures =
        run_solver_benchmark(each, data_folder(), options.device, options.repeats, stop_on_signals());
    if (options.as_json)
      out["scenes"].push_back(json_of(figures));
    else
      print(figures);
  }
  if (options.as_json) std::printf("%s\n", out.dump(2).c_str());
}

}  // namespace

void add_bench_solver(CLI::App& program) {
  CLI::App* command =
      command_group(program, "bench")
          .add_subcommand("solver", "Preconditioners and products side by side on the last system of a scene");
  BenchSolverOptions& o = options_of_command(*command, run_bench_solver);
  command->add_option("--scene", o.scenes, "A scene of bench physics; may stand several times")
      ->allow_extra_args(false)
      ->capture_default_str();
  command->add_option("--repeats", o.repeats, "Measured so often; medians are shown")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen bench solver --scene block_4k --scene towel");
}

}  // namespace pvg
