// Benchmarks of the renderer: rays per second (beside Embree, where that is built in), trees refitted and built, frames
// of named scenes. Everything is warmed up once and then measured `repeats` times; medians are reported.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pvg {

struct Duration {
  double wall = 0, cpu = 0;  // [s]; cpu: of all threads of this process
};

struct RayFigure {
  std::size_t triangles = 0, rays = 0;
  std::string kind;
  Duration ours;
  std::optional<Duration> embree;
  double ratio = 0, cpu_ratio = 0;  // of the speeds, by wall clock and by CPU time; median of the pairs
  std::size_t differences = 0;      // rays of which Embree thinks otherwise
};

struct SceneFigure {
  std::string name;
  int width = 0, height = 0, samples = 0;
  std::size_t triangles = 0, peak_bytes = 0;
  std::uint64_t segments = 0, dropped = 0;
  Duration frame;
  double paths_per_second() const { return double(width) * height * samples / frame.wall; }
};

struct RenderFigures {
  std::string device;
  std::vector<RayFigure> rays;
  std::vector<SceneFigure> scenes;
  std::optional<Duration> refit, rebuild;
  std::size_t tree_triangles = 0;
  std::size_t peak_bytes = 0;
};

struct RenderBenchSettings {
  std::string device;
  int repeats = 5;
  std::filesystem::path data;  // folder that holds tasks/
};

struct RenderBenchmark {
  std::string name, what;
  std::function<void(const RenderBenchSettings&, RenderFigures&)> run;
};

std::vector<RenderBenchmark> render_benchmarks();

}  // namespace pvg
