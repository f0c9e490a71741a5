#include "pipeline/bench/render.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>

#include "host/base/statistics.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/task_file.hpp"
#include "host/render/refit.hpp"
#include "host/render/renderer.hpp"
#include "host/render/traversal.hpp"
#include "pipeline/bench/embree_rays.hpp"
#include "pipeline/bench/render_scenes.hpp"
#include "pipeline/episode/episode.hpp"

namespace pvg {
namespace {

constexpr int SAMPLES = 32;
constexpr int RAYS_PER_PIXEL = 4;

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

Duration median_of(const std::vector<Duration>& durations) {
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
  return median_of(durations);
}

// ---- rays

// one mesh, one instance of it, and the arrays of a batch of rays
class RayBench {
 public:
  RayBench(Device& device, const VisualMesh& mesh)
      : device_(device),
        traversal_(device, device.info().is_gpu),
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
  figure.ours = median_of(our_durations);
  if (!embree) return figure;
  figure.embree = median_of(embree_durations);
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

// ---- trees and frames

void bench_rays(const RenderBenchSettings& settings, std::size_t n, RenderFigures& figures) {
  Device device(settings.device, Purpose::rendering);
  const VisualMesh mesh = bench_room(n);
  RayBench bench(device, mesh);
  std::optional<EmbreeRays> embree;
  if (EmbreeRays::is_there() && !device.info().is_gpu) embree.emplace(mesh, device.info().compute_units);
  EmbreeRays* oracle = embree ? &*embree : nullptr;
  const BenchRays primary = primary_rays(RAYS_PER_PIXEL);
  const std::size_t first = figures.rays.size();
  figures.rays.push_back(compare_closest("primary", primary, settings.repeats, bench, oracle));
  const std::vector<F32x4> hit = bench.result();
  figures.rays.push_back(compare_closest("diffuse", diffuse_rays(mesh, primary, hit), settings.repeats, bench, oracle));
  figures.rays.push_back(compare_shadow(shadow_rays(mesh, primary, hit), settings.repeats, bench, oracle));
  for (std::size_t i = first; i < figures.rays.size(); ++i) figures.rays[i].triangles = mesh.triangles.size();
}

// a mesh of 100k triangles that moves: its tree refitted on the device, and made anew and sent there
void bench_trees(const RenderBenchSettings& settings, RenderFigures& figures) {
  Device device(settings.device, Purpose::rendering);
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
  figures.refit = measure(settings.repeats, [&] {
    refit(range, triangles, vertices, blocks, nodes);
    device.finish();
  });
  figures.rebuild = measure(settings.repeats, [&] {
    rebuild(range, mesh.triangles, vertices, blocks, nodes);
    device.finish();
  });
}

Scene weigh_beaker(const std::filesystem::path& data, int& max_depth) {
  Task task = load_task(data / "tasks" / "weigh_beaker.yaml");
  apply(PictureOverrides{640, 360, SAMPLES, 0}, task);
  max_depth = task.render.max_depth;
  return build_scene_at_middle(task).scene;
}

void bench_frame(const RenderBenchSettings& settings, const std::string& name, const Scene& scene, int samples,
                 int max_depth, RenderFigures& figures) {
  Device device(settings.device, Purpose::rendering);
  RenderSettings render;
  render.samples = samples;
  render.max_depth = max_depth;
  Renderer renderer(device, scene, render);
  SceneFigure figure;
  figure.name = name;
  figure.width = scene.cameras[0].width;
  figure.height = scene.cameras[0].height;
  figure.samples = samples;
  for (const VisualMesh& mesh : scene.visual_meshes) figure.triangles += mesh.triangles.size();
  figure.frame = measure(settings.repeats, [&] {
    const RenderedFrame picture = renderer.render(0, 0);
    figure.segments = picture.rays;
    figure.dropped = picture.dropped_samples;
  });
  figure.peak_bytes = device.peak_bytes();
  figures.scenes.push_back(figure);
}

}  // namespace

std::vector<RenderBenchmark> render_benchmarks() {
  return {
      {"rays_100k", "rays through a mesh of 100k triangles",
       [](const RenderBenchSettings& o, RenderFigures& f) { bench_rays(o, 100000, f); }},
      {"rays_1m", "rays through a mesh of 1M triangles",
       [](const RenderBenchSettings& o, RenderFigures& f) { bench_rays(o, 1000000, f); }},
      {"trees", "a deformed mesh of 100k triangles: refit, rebuild", bench_trees},
      {"cornell_glass", "Cornell's box with a glass ball, 640 x 360, 32 samples",
       [](const RenderBenchSettings& o, RenderFigures& f) {
         bench_frame(o, "cornell_glass", cornell_glass(), SAMPLES, 8, f);
       }},
      {"weigh_beaker", "the front camera of the task, 640 x 360, 32 samples",
       [](const RenderBenchSettings& o, RenderFigures& f) {
         int max_depth = 0;
         const Scene scene = weigh_beaker(o.data, max_depth);
         bench_frame(o, "weigh_beaker", scene, SAMPLES, max_depth, f);
       }},
      {"textured_room", "1M triangles with a texture of 4096 x 4096, one sample: memory",
       [](const RenderBenchSettings& o, RenderFigures& f) {
         bench_frame(o, "textured_room", textured_room(1000000), 1, 4, f);
       }},
  };
}

}  // namespace pvg
