// phyvisgen bench render: rays, trees and frames, measured.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/device/device.hpp"
#include "pipeline/bench/render.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/data_folder.hpp"

namespace pvg {
namespace {

struct BenchRenderOptions {
  std::vector<std::string> scenes;  // names; empty: all
  std::string device;
  int repeats = 5;
  bool as_json = false;
};

nlohmann::ordered_json to_json(const RenderFigures& figures) {
  nlohmann::ordered_json rays = nlohmann::ordered_json::array(), scenes = nlohmann::ordered_json::array();
  for (const RayFigure& r : figures.rays) {
    nlohmann::ordered_json entry = {{"triangles", r.triangles},
                                    {"kind", r.kind},
                                    {"rays", r.rays},
                                    {"mrays_per_second", 1e-6 * double(r.rays) / r.ours.wall},
                                    {"mrays_per_cpu_second", 1e-6 * double(r.rays) / r.ours.cpu},
                                    {"embree_mrays_per_second", nullptr},
                                    {"ratio", nullptr}};
    if (r.embree) {
      entry["embree_mrays_per_second"] = 1e-6 * double(r.rays) / r.embree->wall;
      entry["embree_mrays_per_cpu_second"] = 1e-6 * double(r.rays) / r.embree->cpu;
      entry["ratio"] = r.ratio;
      entry["cpu_ratio"] = r.cpu_ratio;
      entry["differences"] = r.differences;
    }
    rays.push_back(entry);
  }
  for (const SceneFigure& s : figures.scenes)
    scenes.push_back({{"name", s.name},
                      {"width", s.width},
                      {"height", s.height},
                      {"samples", s.samples},
                      {"triangles", s.triangles},
                      {"seconds_per_frame", s.frame.wall},
                      {"cpu_seconds_per_frame", s.frame.cpu},
                      {"paths_per_second", s.paths_per_second()},
                      {"segments", s.segments},
                      {"dropped_samples", s.dropped},
                      {"peak_bytes", s.peak_bytes}});
  nlohmann::ordered_json all = {{"schema", 1}, {"device", figures.device}, {"rays", rays}, {"scenes", scenes}};
  all["refit_ms"] = figures.refit ? nlohmann::ordered_json(1e3 * figures.refit->wall) : nullptr;
  all["rebuild_ms"] = figures.rebuild ? nlohmann::ordered_json(1e3 * figures.rebuild->wall) : nullptr;
  all["refit_cpu_ms"] = figures.refit ? nlohmann::ordered_json(1e3 * figures.refit->cpu) : nullptr;
  all["rebuild_cpu_ms"] = figures.rebuild ? nlohmann::ordered_json(1e3 * figures.rebuild->cpu) : nullptr;
  all["peak_bytes"] = figures.peak_bytes;
  return all;
}

void print(const RenderFigures& figures) {
  std::printf("device %s\n", figures.device.c_str());
  for (const RayFigure& r : figures.rays) {
    std::printf("%8zu triangles  %-8s %7.2f Mrays/s (%.2f per CPU second)", r.triangles, r.kind.c_str(),
                1e-6 * double(r.rays) / r.ours.wall, 1e-6 * double(r.rays) / r.ours.cpu);
    if (r.embree)
      std::printf("   Embree %6.2f (%.2f)   ratio %.2f (%.2f)   %zu of %zu rays differ",
                  1e-6 * double(r.rays) / r.embree->wall, 1e-6 * double(r.rays) / r.embree->cpu, r.ratio, r.cpu_ratio,
                  r.differences, r.rays);
    std::printf("\n");
  }
  if (figures.refit)
    std::printf("%8zu triangles  refit %.2f ms (%.2f of CPU)   rebuild %.1f ms (%.1f of CPU)\n", figures.tree_triangles,
                1e3 * figures.refit->wall, 1e3 * figures.refit->cpu, 1e3 * figures.rebuild->wall,
                1e3 * figures.rebuild->cpu);
  for (const SceneFigure& s : figures.scenes)
    std::printf(
        "%-14s %d x %d, %d samples  %.2f s per frame (%.2f of CPU)   %.3f Mpaths/s   %.2f segments per path   "
        "%.1f MB\n",
        s.name.c_str(), s.width, s.height, s.samples, s.frame.wall, s.frame.cpu, 1e-6 * s.paths_per_second(),
        double(s.segments) / (double(s.width) * s.height * s.samples), 1e-6 * double(s.peak_bytes));
}

void run_bench_render(const BenchRenderOptions& options) {
  std::string names;
  for (const RenderBenchmark& bench : render_benchmarks()) names += (names.empty() ? "" : ", ") + bench.name;
  for (const std::string& name : options.scenes) {
    const std::vector<RenderBenchmark> all = render_benchmarks();
    if (std::none_of(all.begin(), all.end(), [&](const RenderBenchmark& bench) { return bench.name == name; }))
      throw UsageError("--scene " + name + ": there is no such scene; there are: " + names);
  }
  RenderFigures figures;
  figures.device = Device(options.device, Purpose::rendering).info().name;
  for (const RenderBenchmark& bench : render_benchmarks())
    if (options.scenes.empty() ||
        std::find(options.scenes.begin(), options.scenes.end(), bench.name) != options.scenes.end())
      bench.run({options.device, options.repeats, data_folder()}, figures);
  for (const SceneFigure& scene : figures.scenes) figures.peak_bytes = std::max(figures.peak_bytes, scene.peak_bytes);
  options.as_json ? (void)std::printf("%s\n", to_json(figures).dump(2).c_str()) : print(figures);
}

}  // namespace

void add_bench_render(CLI::App& program) {
  CLI::App* command = command_group(program, "bench")
                          .add_subcommand("render", "Rays per second, trees, frames; beside Embree where built in");
  BenchRenderOptions& o = options_of_command(*command, run_bench_render);
  command->add_option("--scene", o.scenes, "Only this one; may stand several times")->allow_extra_args(false);
  command->add_option("--repeats", o.repeats, "Measured so often after a warm-up; medians are shown")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen bench render --scene rays_100k --json");
}

}  // namespace pvg
