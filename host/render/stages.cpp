#include "host/render/stages.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "host/render/pixel_order.hpp"

namespace pvg {
namespace {

// Paths that a work-item of `generate` starts: on a CPU its vector units draw the random numbers of 16 side by side.
std::size_t paths_per_item(bool is_wavefront) { return is_wavefront ? 1 : PACKET; }

// Chunks of TRACE_CHUNK paths: many for each core, as some take ten times as long as others.
std::size_t chunks_at_once(const Device& device) {
  return std::max<std::size_t>(64, 16 * std::size_t(device.info().compute_units));
}

// The bounce from which on leave_glass.cl runs, beyond max_depth: never. Few paths are still in glass then, and those
// that are seldom leave it soon
unsigned first_leaves_glass(const Launch& launch, const DeviceScene& scene) {
  return scene.has_clear_solids ? std::max(1u, launch.max_depth / 2) : launch.max_depth + 1;
}

}  // namespace

Film::Film(Device& device)
    : order(device, 0, "order"),
      sum(device, 0, "film"),
      squares(device, 0, "squares"),
      dropped(device, 0, "dropped"),
      depth(device, 0, "depth"),
      distance(device, 0, "distance"),
      instance(device, 0, "instance"),
      normal(device, 0, "normal"),
      place(device, 0, "place"),
      seen(device, 0, "seen") {}

void Film::begin(std::uint32_t width, std::uint32_t height) {
  const std::size_t n_pixels = std::size_t(width) * height;
  if (width != width_ || height != height_) {
    order.resize(n_pixels);
    order.write(tile_order(width, height));
    width_ = width;
    height_ = height;
  }
  sum.resize(n_pixels);
  squares.resize(n_pixels);
  dropped.resize(n_pixels);
  if (guides) guides->begin(n_pixels);
  if (splats) {
    splats->resize(6 * n_pixels);
    splats->zero();
  }
  sum.zero();
  squares.zero();
  place.resize(n_pixels);
  dropped.zero();
  depth.resize(n_pixels);
  distance.resize(n_pixels);
  seen.resize(n_pixels);
  instance.resize(n_pixels);
  normal.resize(3 * n_pixels);
}

Stages::Kernels::Kernels(Program generate_file, Program compact_file, Program accumulate_file,
                         Program ground_truth_file, Program flow_file, Program camera_media_file, Program holes_file)
    : generate(generate_file.kernel("generate")),
      count_alive(compact_file.kernel("count_alive")),
      fill_queue(compact_file.kernel("fill_queue")),
      accumulate(accumulate_file.kernel("accumulate")),
      ground_truth(ground_truth_file.kernel("ground_truth")),
      flow(flow_file.kernel("flow")),
      camera_media(camera_media_file.kernel("camera_media")),
      pass_holes(holes_file.kernel("pass_holes")),
      shadow_holes(holes_file.kernel("shadow_holes")) {}

LightTracing::LightTracing(Device& device)
    : emit(Program(device, "render/emit.cl", traversal_options(device)).kernel("emit")),
      follow(Program(device, "render/follow.cl", traversal_options(device)).kernel("follow")),
      splat(Program(device, "render/splat.cl", traversal_options(device)).kernel("splat")),
      add_splats(Program(device, "render/splat.cl", traversal_options(device)).kernel("add_splats")) {}

ChunkTracing::ChunkTracing(Device& device)
    : group_instances(Program(device, "render/lanes/trace.cl", traversal_options(device)).kernel("group_instances")),
      trace(Program(device, "render/lanes/trace.cl", traversal_options(device)).kernel("trace")),
      groups(device, 0, "groups"),
      next(device, 1, "next"),
      segments(device, 0, "segments"),
      n_workers(std::max<std::size_t>(1, device.info().compute_units)) {}

void ChunkTracing::find_groups(const Launch& launch, const DeviceScene& scene) {
  const std::size_t n = scene.trees.instances.size();
  groups.resize(std::max<std::size_t>(n, 1));
  group_instances(n, std::uint32_t(n), std::int32_t(launch.environment_light), scene.trees.instances, scene.materials,
                  groups);
}

Wavefront::Wavefront(Device& device)
    : shade(Program(device, "render/wavefront/shade.cl", traversal_options(device)).kernel("shade")),
      leave_glass(Program(device, "render/wavefront/leave_glass.cl", traversal_options(device)).kernel("leave_glass")) {
}

Stages::Stages(Device& device, bool notes_features, bool traces_light, bool is_wavefront)
    : max_paths_(is_wavefront ? std::size_t(1) << 18 : TRACE_CHUNK * chunks_at_once(device)),
      paths_per_item_(paths_per_item(is_wavefront)),
      kernels_(Program(device, "render/wavefront/generate.cl",
                       traversal_options(device) + " -DPATHS=" + std::to_string(paths_per_item_)),
               Program(device, "render/compact.cl"), Program(device, "render/accumulate.cl"),
               Program(device, "sensors/ground_truth.cl", traversal_options(device)),
               Program(device, "sensors/flow.cl", traversal_options(device)),
               Program(device, "render/camera_media.cl", traversal_options(device)),
               Program(device, "render/wavefront/holes.cl", traversal_options(device))),
      traversal_(device, is_wavefront),
      origin_(device, 0, "origin"),
      direction_(device, 0, "direction"),
      throughput_(device, 0, "throughput"),
      radiance_(device, 0, "radiance"),
      hit_(device, 0, "hit"),
      hit_instance_(device, 0, "hit_instance"),
      stream_(device, 0, "stream"),
      shadow_origin_(device, 0, "shadow_origin"),
      shadow_direction_(device, 0, "shadow_direction"),
      shadow_light_(device, 0, "shadow_light"),
      feature_color_(device, 0, "feature_color"),
      feature_normal_(device, 0, "feature_normal"),
      queue_(device, 0, "queue"),
      next_queue_(device, 0, "next_queue"),
      alive_(device, 0, "alive"),
      counts_(device, 0, "counts"),
      offsets_(device, 0, "offsets"),
      scan_(device),
      media_(device, 1, "media") {
  if (is_wavefront)
    wavefront_.emplace(device);
  else
    chunks_.emplace(device);
  if (notes_features) features_.emplace(device);
  if (traces_light) light_tracing_.emplace(device);
}

std::uint64_t Stages::trace_chunks(std::size_t n, const Launch& launch, const Buffer<std::uint32_t>& pixels,
                                   const DeviceScene& scene) {
  const std::size_t n_chunks = divided_up(n, TRACE_CHUNK), n_workers = std::min(n_chunks, chunks_->n_workers);
  resize_slots(n_workers * TRACE_CHUNK);
  radiance_.resize(n);
  if (features_)
    for (Buffer<F32x4>* buffer : {&feature_color_, &feature_normal_}) buffer->resize(n);
  chunks_->segments.resize(n_chunks);
  chunks_->find_groups(launch, scene);
  chunks_->next.zero();
  chunks_->trace(n_workers, std::uint32_t(n), launch, std::uint32_t(features_.has_value()),
                 std::uint32_t(scene.has_cutouts), first_leaves_glass(launch, scene), pixels, chunks_->groups, queue_,
                 stream_, scene.trees.top, scene.trees.nodes, scene.trees.blocks, scene.trees.instances,
                 scene.materials, scene.textures, scene.texels, scene.decode, scene.triangles, scene.vertices,
                 scene.colors, scene.second_uvs, scene.lights, scene.environment, scene.cells, scene.targets, hit_,
                 hit_instance_, origin_, direction_, throughput_, radiance_, shadow_origin_, shadow_direction_,
                 shadow_light_, alive_, feature_color_, feature_normal_, chunks_->next, chunks_->segments);
  const std::vector<std::uint32_t> segments = chunks_->segments.read(0, n_chunks);
  return std::accumulate(segments.begin(), segments.end(), std::uint64_t(0));
}

std::uint64_t Stages::trace_wavefront(std::size_t n, const Launch& launch, const Buffer<std::uint32_t>& pixels,
                                      const DeviceScene& scene) {
  generate(n, launch, pixels);
  std::uint64_t segments = 0;
  for (unsigned depth = 0; depth <= launch.max_depth && n > 0; ++depth) {
    segments += n;
    if (depth >= first_leaves_glass(launch, scene)) leave_glass(n, depth, scene);
    intersect(n, scene);
    if (scene.has_cutouts) pass_holes(n, depth, scene);
    shade(n, launch, depth, scene);
    // without lamps too: a receiver's ambient share comes from all around
    if (scene.has_cutouts) shadow_holes(n, scene);
    shadow(n, launch, scene);
    n = compact(n);
  }
  return segments;
}

std::uint64_t Stages::trace(const Launch& launch, const Buffer<std::uint32_t>& pixels, const DeviceScene& scene,
                            Film& film) {
  const std::size_t n = std::size_t(launch.n_pixels) * launch.n_samples;
  const std::uint64_t segments =
      chunks_ ? trace_chunks(n, launch, pixels, scene) : trace_wavefront(n, launch, pixels, scene);
  kernels_.accumulate(launch.n_pixels, launch.n_pixels, launch, pixels, radiance_, film.sum, film.squares,
                      film.dropped);
  if (features_) features_->accumulate(launch, pixels, feature_color_, feature_normal_, film.guides.value());
  return segments;
}

std::uint64_t Stages::trace_light(Launch launch, std::uint32_t first, std::uint32_t last, const DeviceScene& scene,
                                  Film& film) {
  LightTracing& k = light_tracing_.value();
  std::uint64_t segments = 0;
  for (std::uint64_t at = first; at < last; at += max_paths_) {
    std::size_t n = std::size_t(std::min<std::uint64_t>(max_paths_, last - at));
    launch.first_sample = std::uint32_t(at);
    resize_slots(n);
    k.emit(n, std::uint32_t(n), launch, scene.trees.instances, scene.materials, scene.textures, scene.texels,
           scene.decode, scene.triangles, scene.vertices, scene.second_uvs, scene.lights, scene.targets, origin_,
           direction_, throughput_, radiance_, stream_, queue_, alive_);
    n = compact(n);
    for (unsigned depth = 0; depth < launch.max_depth && n > 0; ++depth) {
      segments += n;
      intersect(n, scene);
      if (scene.has_cutouts) pass_holes(n, depth, scene);
      k.follow(n, std::uint32_t(n), launch, std::uint32_t(depth), queue_, stream_, scene.trees.instances,
               scene.materials, scene.textures, scene.texels, scene.decode, scene.triangles, scene.vertices,
               scene.colors, scene.second_uvs, hit_, hit_instance_, radiance_, origin_, direction_, throughput_,
               shadow_origin_, shadow_direction_, shadow_light_, alive_);
      if (scene.has_cutouts) shadow_holes(n, scene);
      k.splat(n, std::uint32_t(n), queue_, scene.trees.top, scene.trees.nodes, scene.trees.blocks,
              scene.trees.instances, shadow_origin_, shadow_direction_, shadow_light_, film.splats.value(),
              film.dropped);
      n = compact(n);
    }
  }
  return segments;
}

void Stages::add_light(const Launch& launch, Film& film) {
  const std::uint32_t n = launch.camera.width * launch.camera.height;
  light_tracing_.value().add_splats(n, n, launch, film.splats.value(), film.sum);
}

void Stages::find_ground_truth(const Launch& launch, bool sees_through_glass, const DeviceScene& scene, Film& film) {
  generate(launch.n_pixels, launch, film.order);
  kernels_.ground_truth(launch.n_pixels, launch.n_pixels, launch, film.order, std::uint32_t(sees_through_glass),
                        scene.trees.top, scene.trees.nodes, scene.trees.blocks, scene.trees.instances, scene.materials,
                        scene.triangles, scene.vertices, scene.textures, scene.texels, scene.second_uvs, origin_,
                        direction_, throughput_, film.depth, film.distance, film.instance, film.normal, film.seen,
                        film.place);
}

void Stages::find_flow(const Launch& from, const Launch& to, const DeviceScene& scene, const Film& film,
                       Buffer<float>& flow, Buffer<std::uint8_t>& state) {
  const std::uint32_t n = std::uint32_t(film.seen.size());
  kernels_.flow(n, n, from, to, scene.trees.top, scene.trees.nodes, scene.trees.blocks, scene.trees.instances,
                scene.materials, scene.textures, scene.texels, scene.triangles, scene.vertices, scene.second_uvs,
                film.seen, flow, state);
}

std::uint32_t Stages::find_camera_media(const Launch& launch, const DeviceScene& scene) {
  kernels_.camera_media(1, launch, scene.trees.top, scene.trees.nodes, scene.trees.blocks, scene.trees.instances,
                        scene.materials, scene.triangles, scene.vertices, media_);
  return media_.read().front();
}

void Stages::resize_slots(std::size_t n) {
  for (Buffer<F32x4>* buffer :
       {&origin_, &direction_, &throughput_, &radiance_, &hit_, &shadow_origin_, &shadow_direction_, &shadow_light_})
    buffer->resize(n);
  if (features_)
    for (Buffer<F32x4>* buffer : {&feature_color_, &feature_normal_}) buffer->resize(n);
  stream_.resize(n);
  for (Buffer<std::uint32_t>* buffer : {&hit_instance_, &queue_, &next_queue_, &alive_}) buffer->resize(n);
}

void Stages::generate(std::size_t n, const Launch& launch, const Buffer<std::uint32_t>& pixels) {
  resize_slots(n);
  kernels_.generate(divided_up(n, paths_per_item_), std::uint32_t(n), launch, pixels, origin_, direction_, throughput_,
                    radiance_, stream_, queue_);
}

void Stages::intersect(std::size_t n, const DeviceScene& scene) {
  traversal_.find_closest(n, queue_, scene.trees, origin_, direction_, hit_, hit_instance_);
}

void Stages::pass_holes(std::size_t n, unsigned depth, const DeviceScene& scene) {
  kernels_.pass_holes(n, std::uint32_t(n), std::uint32_t(depth), queue_, stream_, scene.trees.top, scene.trees.nodes,
                      scene.trees.blocks, scene.trees.instances, scene.materials, scene.textures, scene.texels,
                      scene.triangles, scene.vertices, scene.second_uvs, origin_, direction_, hit_, hit_instance_);
}

void Stages::leave_glass(std::size_t n, unsigned depth, const DeviceScene& scene) {
  wavefront_->leave_glass(n, std::uint32_t(n), std::uint32_t(depth), std::uint32_t(features_.has_value()), queue_,
                          stream_, scene.trees.top, scene.trees.nodes, scene.trees.blocks, scene.trees.instances,
                          scene.materials, scene.textures, scene.texels, scene.decode, scene.triangles, scene.vertices,
                          scene.colors, scene.second_uvs, origin_, direction_, throughput_, feature_color_);
}

void Stages::shadow_holes(std::size_t n, const DeviceScene& scene) {
  kernels_.shadow_holes(n, std::uint32_t(n), queue_, scene.trees.top, scene.trees.nodes, scene.trees.blocks,
                        scene.trees.instances, scene.materials, scene.textures, scene.texels, scene.triangles,
                        scene.vertices, scene.second_uvs, shadow_origin_, shadow_direction_, shadow_light_);
}

void Stages::shade(std::size_t n, const Launch& launch, unsigned depth, const DeviceScene& scene) {
  wavefront_->shade(n, std::uint32_t(n), launch, std::uint32_t(depth), std::uint32_t(features_.has_value()), queue_,
                    stream_, scene.trees.instances, scene.materials, scene.textures, scene.texels, scene.decode,
                    scene.triangles, scene.vertices, scene.colors, scene.second_uvs, scene.lights, scene.environment,
                    scene.cells, scene.targets, hit_, hit_instance_, origin_, direction_, throughput_, radiance_,
                    shadow_origin_, shadow_direction_, shadow_light_, alive_, feature_color_, feature_normal_);
}

void Stages::shadow(std::size_t n, const Launch& launch, const DeviceScene& scene) {
  traversal_.add_light(n, queue_, launch.transparent_shadows, scene.trees, scene.materials, shadow_origin_,
                       shadow_direction_, shadow_light_, radiance_);
}

std::size_t Stages::compact(std::size_t n) {
  constexpr std::size_t PIECE = 64;  // as in compact.cl
  const std::size_t n_pieces = divided_up(n, PIECE);
  counts_.resize(n_pieces);
  kernels_.count_alive(n_pieces, std::uint32_t(n_pieces), std::uint32_t(n), alive_, counts_);
  scan_(n_pieces, counts_, offsets_);
  kernels_.fill_queue(n_pieces, std::uint32_t(n_pieces), std::uint32_t(n), alive_, offsets_, queue_, next_queue_);
  std::swap(queue_, next_queue_);
  return offsets_.read(n_pieces, 1).front();
}

}  // namespace pvg
