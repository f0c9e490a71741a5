// phyvisgen bench render: rays per second (beside Embree, where that is built in), trees refitted and built, frames of
// named scenes. Everything is warmed up once and then measured `repeats` times; medians are reported.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/load/build_scene.hpp"
#include "host/load/task_file.hpp"
#include "host/render/refit.hpp"
#include "host/render/renderer.hpp"
#include "host/render/traversal.hpp"
#include "pipeline/bench/embree_rays.hpp"
#include "pipeline/bench/render_scenes.hpp"
#include "pipeline/commands/commands.hpp"
#include "pipeline/commands/data_folder.hpp"

namespace pvg {
namespace {

constexpr int SAMPLES = 32;
constexpr int RAYS_PER_PIXEL = 4;

struct Duration {
  double wall = 0, cpu = 0;  // [s]; cpu: of all threads of this process
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

Duration measure(const std::function<void()>& job) {
  const auto cpu_seconds = [] {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  };
  const double cpu = cpu_seconds();
  const auto start = std::chrono::steady_clock::now();
  job();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {wall, cpu_seconds() - cpu};
}

Duration median(const std::vector<Duration>& durations) {
  std::vector<double> wall, cpu;
  for (const Duration& d : durations) {
    wall.push_back(d.wall);
    cpu.push_back(d.cpu);
  }
  return {median(wall), median(cpu)};
}

Duration measure(int repeats, const std::function<void()>& job) {
  job();
  std::vector<Duration> durations;
  for (int i = 0; i < repeats; ++i) durations.push_back(measure(job));
  return median(durations);
}

// ---- rays -------------------------------------------------------------------------------------------------------

struct RayFigure {
  std::size_t triangles = 0, rays = 0;
  std::string kind;
  Duration ours;
  std::optional<Duration> embree;
  double ratio = 0, cpu_ratio = 0;  // of the speeds, by wall clock and by CPU time; median of the pairs
  std::size_t differences = 0;      // rays of which Embree thinks otherwise
};

// one mesh, one instance of it, and the arrays of a batch of rays
class RayBench {
 public:
  RayBench(Device& device, const VisualMesh& mesh)
      : device_(device),
        traversal_(device),
        range_(geometry_.add(mesh, "bench")),
        trees_(make_trees()),
        materials_(device, 1, "materials") {
    materials_.zero();
  }

  void load(const BenchRays& rays) {
    const std::size_t n = rays.size();
    std::vector<std::uint32_t> queue(n);
    for (std::size_t i = 0; i < n; ++i) queue[i] = std::uint32_t(i);
    for (Buffer<F32x4>* buffer : {&origin_, &direction_, &hit_, &light_}) buffer->resize(n);
    hit_instance_.resize(n);
    queue_.resize(n);
    queue_.write(queue);
    origin_.write(rays.origin);
    direction_.write(rays.direction);
  }
  void find_closest() {
    traversal_.find_closest(queue_.size(), queue_, trees_, origin_, direction_, hit_, hit_instance_);
    device_.finish();
  }
  // shadow rays carry their kind in the origin, and one unit of light each
  void load_shadow(BenchRays rays) {
    for (F32x4& origin : rays.origin) {
      const std::uint32_t kind = SHADOW_SURFACE;
      std::memcpy(&origin.v[3], &kind, sizeof kind);
    }
    load(rays);
    light_.write(std::vector<F32x4>(rays.size(), F32x4{{1, 1, 1, 1}}));
    hit_.zero();  // what arrives of the light is added: 0 stays where it never does
  }
  void add_light() {
    traversal_.add_light(queue_.size(), queue_, false, trees_, materials_, origin_, direction_, light_, hit_);
    device_.finish();
  }
  std::vector<F32x4> result() const { return hit_.read(); }

 private:
  DeviceTrees make_trees() {
    Instance instance = make_instance(Pose::Identity().matrix().topRows<3>(), range_, "bench");
    instance.mask = MASK_SURFACES;
    return {Buffer<BvhNode>(device_, build_instance_tree({world_box(instance, range_.box)}), "top"),
            Buffer<BvhNode>(device_, geometry_.nodes, "nodes"),
            Buffer<TriangleBlock>(device_, geometry_.blocks, "blocks"),
            Buffer<Instance>(device_, std::vector<Instance>{instance}, "instances")};
  }

  Device& device_;
  Traversal traversal_;
  GeometryArrays geometry_;
  MeshRange range_;
  DeviceTrees trees_;
  Buffer<Material> materials_;
  Buffer<F32x4> origin_{device_, 0, "origin"}, direction_{device_, 0, "direction"}, hit_{device_, 0, "hit"},
      light_{device_, 0, "light"};
  Buffer<std::uint32_t> queue_{device_, 0, "queue"}, hit_instance_{device_, 0, "hit_instance"};
};

// one run after the other, so that both see the same machine
RayFigure compare(const std::string& kind, const BenchRays& rays, int repeats, const std::function<void()>& ours,
                  const std::function<void()>& embree) {
  RayFigure figure;
  figure.kind = kind;
  figure.rays = rays.size();
  std::vector<Duration> our_durations, embree_durations;
  std::vector<double> ratios, cpu_ratios;
  for (int i = -1; i < repeats; ++i) {
    const Duration a = measure(ours), b = embree ? measure(embree) : Duration{};
    if (i < 0) continue;
    our_durations.push_back(a);
    embree_durations.push_back(b);
    ratios.push_back(b.wall / a.wall);
    cpu_ratios.push_back(b.cpu / a.cpu);
  }
  figure.ours = median(our_durations);
  if (!embree) return figure;
  figure.embree = median(embree_durations);
  figure.ratio = median(ratios);
  figure.cpu_ratio = median(cpu_ratios);
  return figure;
}

RayFigure compare_closest(const std::string& kind, const BenchRays& rays, int repeats, RayBench& bench,
                          EmbreeRays* embree) {
  std::vector<EmbreeRays::Hit> hits;
  bench.load(rays);
  RayFigure figure = compare(
      kind, rays, repeats, [&] { bench.find_closest(); },
      embree ? std::function<void()>([&] { embree->closest(rays, hits); }) : nullptr);
  const std::vector<F32x4> ours = bench.result();
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const float a = ours[i].v[0], b = hits[i].t;
    figure.differences += a != b && !(std::abs(a - b) <= 1e-3f * b);
  }
  return figure;
}

RayFigure compare_shadow(const BenchRays& rays, int repeats, RayBench& bench, EmbreeRays* embree) {
  std::vector<std::uint8_t> is_occluded;
  bench.load_shadow(rays);
  RayFigure figure = compare(
      "shadow", rays, repeats, [&] { bench.add_light(); },
      embree ? std::function<void()>([&] { embree->any(rays, 0.9999f, is_occluded); }) : nullptr);
  const std::vector<F32x4> ours = bench.result();
  for (std::size_t i = 0; i < is_occluded.size(); ++i) figure.differences += (ours[i].v[0] == 0) != is_occluded[i];
  return figure;
}

// ---- what is reported -------------------------------------------------------------------------------------------

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

void bench_rays(const BenchRenderOptions& options, std::size_t n, RenderFigures& figures) {
  Device device(options.device, Purpose::rendering);
  const VisualMesh mesh = bench_room(n);
  RayBench bench(device, mesh);
  std::optional<EmbreeRays> embree;
  if (EmbreeRays::is_there() && !device.info().is_gpu) embree.emplace(mesh, device.info().compute_units);
  EmbreeRays* yardstick = embree ? &*embree : nullptr;
  const BenchRays primary = primary_rays(RAYS_PER_PIXEL);
  const std::size_t first = figures.rays.size();
  figures.rays.push_back(compare_closest("primary", primary, options.repeats, bench, yardstick));
  const std::vector<F32x4> hit = bench.result();
  figures.rays.push_back(
      compare_closest("diffuse", diffuse_rays(mesh, primary, hit), options.repeats, bench, yardstick));
  figures.rays.push_back(compare_shadow(shadow_rays(mesh, primary, hit), options.repeats, bench, yardstick));
  for (std::size_t i = first; i < figures.rays.size(); ++i) figures.rays[i].triangles = mesh.triangles.size();
}

// a mesh of 100k triangles that moves: its tree refitted on the device, and made anew and sent there
void bench_trees(const BenchRenderOptions& options, RenderFigures& figures) {
  Device device(options.device, Purpose::rendering);
  const VisualMesh mesh = bench_room(100000);
  GeometryArrays geometry;
  MeshRange range = geometry.add(mesh, "bench", true);
  Buffer<BvhNode> nodes(device, geometry.nodes, "nodes");
  Buffer<TriangleBlock> blocks(device, geometry.blocks, "blocks");
  const Buffer<std::uint32_t> triangles(device, geometry.triangles, "triangles");
  for (Vertex& vertex : geometry.vertices) vertex.point[2] += 0.1f * std::sin(vertex.point[0]);
  const Buffer<Vertex> vertices(device, geometry.vertices, "vertices");
  Refit refit(device);
  figures.tree_triangles = mesh.triangles.size();
  figures.refit = measure(options.repeats, [&] {
    refit(range, triangles, vertices, blocks, nodes);
    device.finish();
  });
  figures.rebuild = measure(options.repeats, [&] {
    rebuild(range, mesh.triangles, vertices, blocks, nodes);
    device.finish();
  });
}

Scene weigh_beaker(int& max_depth) {
  Task task = load_task(data_folder() / "tasks" / "weigh_beaker.yaml");
  apply(PictureOverrides{640, 360, SAMPLES, 0}, task);
  max_depth = task.render.max_depth;
  return build_scene_at_middle(task).scene;
}

void bench_frame(const BenchRenderOptions& options, const std::string& name, const Scene& scene, int samples,
                 int max_depth, RenderFigures& figures) {
  Device device(options.device, Purpose::rendering);
  RenderSettings settings;
  settings.samples = samples;
  settings.max_depth = max_depth;
  Renderer renderer(device, scene, settings);
  SceneFigure figure;
  figure.name = name;
  figure.width = scene.cameras[0].width;
  figure.height = scene.cameras[0].height;
  figure.samples = samples;
  for (const VisualMesh& mesh : scene.visual_meshes) figure.triangles += mesh.triangles.size();
  figure.frame = measure(options.repeats, [&] {
    const RenderedFrame picture = renderer.render(0, 0);
    figure.segments = picture.rays;
    figure.dropped = picture.dropped_samples;
  });
  figure.peak_bytes = device.peak_bytes();
  figures.scenes.push_back(figure);
}

struct NamedBench {
  std::string name, what;
  std::function<void(const BenchRenderOptions&, RenderFigures&)> run;
};

std::vector<NamedBench> benches() {
  return {
      {"rays_100k", "rays through a mesh of 100k triangles",
       [](const BenchRenderOptions& o, RenderFigures& f) { bench_rays(o, 100000, f); }},
      {"rays_1m", "rays through a mesh of 1M triangles",
       [](const BenchRenderOptions& o, RenderFigures& f) { bench_rays(o, 1000000, f); }},
      {"trees", "a deformed mesh of 100k triangles: refit, rebuild", bench_trees},
      {"cornell_glass", "Cornell's box with a glass ball, 640 x 360, 32 samples",
       [](const BenchRenderOptions& o, RenderFigures& f) {
         bench_frame(o, "cornell_glass", cornell_glass(), SAMPLES, 8, f);
       }},
      {"weigh_beaker", "the front camera of the task, 640 x 360, 32 samples",
       [](const BenchRenderOptions& o, RenderFigures& f) {
         int max_depth = 0;
         const Scene scene = weigh_beaker(max_depth);
         bench_frame(o, "weigh_beaker", scene, SAMPLES, max_depth, f);
       }},
      {"textured_room", "1M triangles with a texture of 4096 x 4096, one sample: memory",
       [](const BenchRenderOptions& o, RenderFigures& f) {
         bench_frame(o, "textured_room", textured_room(1000000), 1, 4, f);
       }},
  };
}

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

}  // namespace

void run_bench_render(const BenchRenderOptions& options) {
  std::string names;
  for (const NamedBench& bench : benches()) names += (names.empty() ? "" : ", ") + bench.name;
  for (const std::string& name : options.scenes) {
    const std::vector<NamedBench> all = benches();
    if (std::none_of(all.begin(), all.end(), [&](const NamedBench& bench) { return bench.name == name; }))
      throw UsageError("--scene " + name + ": there is no such scene; there are: " + names);
  }
  RenderFigures figures;
  figures.device = Device(options.device, Purpose::rendering).info().name;
  for (const NamedBench& bench : benches())
    if (options.scenes.empty() ||
        std::find(options.scenes.begin(), options.scenes.end(), bench.name) != options.scenes.end())
      bench.run(options, figures);
  for (const SceneFigure& scene : figures.scenes) figures.peak_bytes = std::max(figures.peak_bytes, scene.peak_bytes);
  options.as_json ? (void)std::printf("%s\n", to_json(figures).dump(2).c_str()) : print(figures);
}

}  // namespace pvg
