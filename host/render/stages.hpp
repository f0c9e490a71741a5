// The stages of the path tracer on the device: programs, the arrays that paths travel in, and one function per use.
#pragma once
#include <optional>
#include <vector>

#include "host/device/scan.hpp"
#include "host/render/features.hpp"
#include "host/render/traversal.hpp"

namespace pvg {

// What the stages read of the scene.
struct DeviceScene {
  DeviceTrees trees;
  Buffer<std::uint32_t> triangles;  // [n x 3]
  Buffer<Vertex> vertices;
  Buffer<Material> materials;
  Buffer<TextureInfo> textures;
  Buffer<std::uint32_t> texels;  // RGBA bytes
  Buffer<float> decode;          // [512]
  Buffer<float> colors;          // [n x 3]
  Buffer<float> second_uvs;      // [n x 2]
  Buffer<Light> lights;
  Buffer<float> environment;  // [height x width x 3]
  Buffer<EnvironmentCell> cells;
  Buffer<F32x4> targets;     // of light paths: centre, radius [m]
  bool has_cutouts = false;  // of its instances any has INSTANCE_CUTOUT
  bool has_clear_solids = false;
};

// What a picture is gathered in  [height x width].
struct Film {
  explicit Film(Device& device);
  void begin(std::uint32_t width, std::uint32_t height);  // empties it
  Buffer<std::uint32_t> order;                            // of its pixels: tile_order
  Buffer<F32x4> sum;                                      // of radiance; last: samples in it
  Buffer<float> squares;                                  // of luminance
  Buffer<std::uint32_t> dropped;
  Buffer<float> depth, distance;
  Buffer<std::uint32_t> instance;
  Buffer<float> normal;                         // [n x 3]
  Buffer<F32x4> place;                          // the point at the middle, last: its distance [m]
  Buffer<F32x4> seen;                           // the hit at the middle: u, v, triangle, instance
  std::optional<Guides> guides;                 // of renderers that denoise or show them
  std::optional<Buffer<std::uint32_t>> splats;  // of renderers that trace light

 private:
  std::uint32_t width_ = 0, height_ = 0;
};

// Kernels of paths from the lamps, see kernels/render/light_tracing.cl.
struct LightTracing {
  explicit LightTracing(Device& device);
  Kernel emit, follow, splat, add_splats;
};

// All stages in one kernel, on a CPU, see kernels/render/lanes/trace.cl.
struct ChunkTracing {
  explicit ChunkTracing(Device& device);
  void find_groups(const Launch& launch, const DeviceScene& scene);
  Kernel group_instances, trace;
  Buffer<std::uint8_t> groups;     // [instances] which surfaces each has
  Buffer<std::uint32_t> next;      // [1] the first chunk that nobody has
  Buffer<std::uint32_t> segments;  // [chunks] traced
  std::size_t n_workers;           // work-items, one for each core; each has TRACE_CHUNK slots of its own
};

// A kernel for each stage, as a GPU needs it, see kernels/render/wavefront. The other stages: Kernels and Traversal.
struct Wavefront {
  explicit Wavefront(Device& device);
  Kernel shade, leave_glass;
};

class Stages {
 public:
  // notes_features: for the guides of the films;  traces_light: for their splats;  is_wavefront: each stage is a launch
  Stages(Device& device, bool notes_features, bool traces_light, bool is_wavefront);
  // At most so many paths are under way at once, about 150 bytes each: what keeps the device busy.
  std::size_t max_paths() const { return max_paths_; }
  // follows the paths of the launch's part of the pixels to their end and adds them to the film; the number of segments
  // traced
  std::uint64_t trace(const Launch& launch, const Buffer<std::uint32_t>& pixels, const DeviceScene& scene, Film& film);
  // Follows the light paths first .. last - 1 of the launch's picture; the number of segments traced.
  std::uint64_t trace_light(Launch launch, std::uint32_t first, std::uint32_t last, const DeviceScene& scene,
                            Film& film);
  // what they brought goes into the film; once, after all samples
  void add_light(const Launch& launch, Film& film);
  // one ray per pixel of the launch, of the film's order
  void find_ground_truth(const Launch& launch, bool sees_through_glass, const DeviceScene& scene, Film& film);
  // where the points of the film's last ground truth are in the picture `to`, whose scene this is
  void find_flow(const Launch& from, const Launch& to, const DeviceScene& scene, const Film& film, Buffer<float>& flow,
                 Buffer<std::uint8_t>& state);
  // the solids that the launch's camera is inside of, see kernels/render/media.cl
  std::uint32_t find_camera_media(const Launch& launch, const DeviceScene& scene);

 private:
  void resize_slots(std::size_t n);
  void generate(std::size_t n, const Launch& launch, const Buffer<std::uint32_t>& pixels);
  void intersect(std::size_t n, const DeviceScene& scene);
  void pass_holes(std::size_t n, unsigned depth, const DeviceScene& scene);
  void leave_glass(std::size_t n, unsigned depth, const DeviceScene& scene);
  std::uint64_t trace_chunks(std::size_t n, const Launch& launch, const Buffer<std::uint32_t>& pixels,
                             const DeviceScene& scene);
  std::uint64_t trace_wavefront(std::size_t n, const Launch& launch, const Buffer<std::uint32_t>& pixels,
                                const DeviceScene& scene);
  void shade(std::size_t n, const Launch& launch, unsigned depth, const DeviceScene& scene);
  void shadow_holes(std::size_t n, const DeviceScene& scene);
  void shadow(std::size_t n, const Launch& launch, const DeviceScene& scene);
  std::size_t compact(std::size_t n);  // live paths

  struct Kernels {
    Kernels(Program generate_file, Program compact_file, Program accumulate_file, Program ground_truth_file,
            Program flow_file, Program camera_media_file, Program holes_file);
    Kernel generate, count_alive, fill_queue, accumulate, ground_truth, flow, camera_media;
    Kernel pass_holes, shadow_holes;
  };
  std::size_t max_paths_, paths_per_item_;
  Kernels kernels_;
  Traversal traversal_;
  std::optional<ChunkTracing> chunks_;  // one of these two, by is_wavefront
  std::optional<Wavefront> wavefront_;
  std::optional<Features> features_;
  std::optional<LightTracing> light_tracing_;
  // per slot
  Buffer<F32x4> origin_, direction_, throughput_, radiance_, hit_;
  Buffer<std::uint32_t> hit_instance_;
  Buffer<std::uint64_t> stream_;  // uint2 of key and sample
  Buffer<F32x4> shadow_origin_, shadow_direction_, shadow_light_;
  Buffer<F32x4> feature_color_, feature_normal_;  // empty where none are noted
  // per place in the queue
  Buffer<std::uint32_t> queue_, next_queue_, alive_;
  Buffer<std::uint32_t> counts_, offsets_;
  Scan scan_;
  Buffer<std::uint32_t> media_;  // one number
};

}  // namespace pvg
