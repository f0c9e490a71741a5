// A picture: every visual is moved to its body, the tree over instances rebuilt, then batches of paths run through the
// stages (stages.cpp) into the film.
#include <algorithm>
#include <cmath>

#include "host/base/counted.hpp"
#include "host/render/adaptive.hpp"
#include "host/render/camera.hpp"
#include "host/render/pixel_order.hpp"
#include "host/render/renderer_impl.hpp"

namespace pvg {
namespace {

constexpr int LEAST_FIRST_SAMPLES = 4;  // of a pixel, from which its noise is estimated
constexpr int ROUNDS = 3;               // in which the rest is shared out
constexpr int MOST_INSTANTS = 16;       // of a moving picture
// Every light path goes where light is thrown, to many surfaces. On Cornell's box with glass error times processor time
// is least here (docs/measured/2026-11-29_chunks.md)
constexpr double LIGHT_PATHS_PER_PATH = 0.0175;
constexpr std::uint32_t STRIP_ROWS = TILE;  // that a rolling shutter reads together: those of a row of tiles

std::uint32_t light_paths_of(int samples, std::size_t n_pixels) {
  const double most = 1u << 31;
  return std::uint32_t(std::clamp(LIGHT_PATHS_PER_PATH * double(samples) * double(n_pixels), 1.0, most));
}

}  // namespace

Launch Renderer::Impl::begin_launch(int camera, std::uint32_t frame) {
  const Camera& seen_by = scene.cameras[camera];
  Launch launch{};
  launch.camera = pinhole_camera(seen_by, camera_poses[camera]);
  launch.key = picture_key(settings.seed, frame, std::uint32_t(camera));
  launch.n_lights = std::uint32_t(lights.lights.size());
  launch.max_depth = std::uint32_t(settings.max_depth);
  launch.transparent_shadows = settings.transparent_shadows;
  launch.receiver_scale = 1.0f / seen_by.exposure;
  for (int c = 0; c < 3; ++c) launch.environment[c] = scene.environment[c];
  launch.environment_light = lights.environment;
  launch.environment_turn = float(scene.environment_map.turn);
  launch.environment_width = std::uint32_t(scene.environment_map.width);
  launch.environment_height = std::uint32_t(scene.environment_map.height);
  // strips of a rolling shutter would take all light paths each: their cameras' own paths find that light, as they can
  if (traces_light && seen_by.row_time == 0) {
    launch.n_light_paths = light_paths_of(settings.samples, std::size_t(seen_by.width) * std::size_t(seen_by.height));
    launch.light_paths_per_sample = float(launch.n_light_paths) / float(settings.samples);
    launch.n_targets = std::uint32_t(on_device->targets.size());
  }
  if (has_insides) launch.media = stages.find_camera_media(launch, *on_device);
  return launch;
}

std::uint64_t Renderer::Impl::add_samples(Launch launch, const Buffer<std::uint32_t>& pixels, std::uint32_t first,
                                          std::uint32_t last, int first_sample, int n_samples) {
  std::uint64_t rays = 0;
  // more samples than a batch can hold go one part after the other
  const int at_once = int(std::min<std::size_t>(std::size_t(n_samples), stages.max_paths()));
  for (int sample = 0; sample < n_samples; sample += at_once) {
    launch.first_sample = std::uint32_t(first_sample + sample);
    launch.n_samples = std::uint32_t(std::min(at_once, n_samples - sample));
    const std::uint32_t batch = std::uint32_t(std::max<std::size_t>(1, stages.max_paths() / launch.n_samples));
    for (launch.first_pixel = first; launch.first_pixel < last; launch.first_pixel += batch) {
      launch.n_pixels = std::min(batch, last - launch.first_pixel);
      rays += stages.trace(launch, pixels, *on_device, film);
    }
  }
  return rays;
}

std::uint64_t Renderer::Impl::add_light_paths(const Launch& launch, int first_sample, int n_samples) {
  if (launch.n_light_paths == 0) return 0;
  const auto paths_before = [&](int sample) {
    return std::uint32_t(std::uint64_t(launch.n_light_paths) * std::uint64_t(sample) / std::uint64_t(settings.samples));
  };
  return stages.trace_light(launch, paths_before(first_sample), paths_before(first_sample + n_samples), *on_device,
                            film);
}

// A first part goes to all pixels, the rest in rounds to those whose noise it shows.
std::uint64_t Renderer::Impl::add_adaptive_samples(const Launch& launch, float exposure) {
  const std::uint32_t width = launch.camera.width, n_pixels = width * launch.camera.height;
  const int first_round = std::min(settings.samples, std::max(LEAST_FIRST_SAMPLES, settings.samples / 4));
  std::uint64_t rays = add_samples(launch, film.order, 0, n_pixels, 0, first_round);
  std::vector<std::uint32_t> counts(n_pixels, std::uint32_t(first_round));
  const std::vector<std::uint32_t> order = film.order.read();
  for (int round = 1; round <= ROUNDS; ++round) {
    const int mean = first_round + (settings.samples - first_round) * round / ROUNDS;
    const std::vector<std::uint32_t> wanted = doubled_counts(
        path_variances(film.sum.read(), film.squares.read(), width, exposure), counts, std::uint64_t(mean) * n_pixels);
    for (std::uint32_t count = std::uint32_t(first_round);; count *= 2) {
      std::vector<std::uint32_t> pixels;
      bool goes_on = false;
      for (const std::uint32_t pixel : order) {
        goes_on |= wanted[pixel] > count;
        if (counts[pixel] == count && wanted[pixel] > count) pixels.push_back(pixel);
      }
      if (!goes_on) break;
      chosen.resize(pixels.size());
      chosen.write(pixels);
      rays += add_samples(launch, chosen, 0, std::uint32_t(pixels.size()), int(count), int(count));
      for (const std::uint32_t pixel : pixels) counts[pixel] *= 2;
    }
  }
  return rays;
}

// Samples are shared out among instants of the exposure, one at random in each of equal parts of it; strips of rows
// have their own. After it everything stands where it is at `time`.
std::uint64_t Renderer::Impl::add_moving_samples(int camera, std::uint32_t frame,
                                                 const std::function<SceneState(double)>& at, double time) {
  const Camera& seen_by = scene.cameras[camera];
  const std::uint32_t width = std::uint32_t(seen_by.width), height = std::uint32_t(seen_by.height);
  const std::uint32_t strip_rows = seen_by.row_time > 0 ? STRIP_ROWS : height;
  const int n_instants = seen_by.exposure_time > 0 ? std::min(settings.samples, MOST_INSTANTS) : 1;
  std::uint64_t rays = 0;
  for (std::uint32_t row = 0; row < height; row += strip_rows) {
    const std::uint32_t end = std::min(height, row + strip_rows);
    const double middle = 0.5 * (row + end - 1);
    const double closes = time - (seen_by.row_time > 0 ? (height - 1 - middle) * seen_by.row_time : 0);
    for (int k = 0; k < n_instants; ++k) {
      const std::uint32_t key = picture_key(settings.seed ^ (std::uint64_t(row) << 32), frame, std::uint32_t(k));
      const double within = (k + double(key) * 0x1p-32) / n_instants;
      move_to(at(closes - seen_by.exposure_time * (1 - within)));
      const int first = settings.samples * k / n_instants, last = settings.samples * (k + 1) / n_instants;
      const Launch launch = begin_launch(camera, frame);
      rays += add_samples(launch, film.order, row * width, end * width, first, last - first);
      rays += add_light_paths(launch, first, last - first);
    }
  }
  move_to(at(time));
  return rays;
}

void Renderer::Impl::find_ground_truth(Launch launch) {
  launch.is_center = 1;
  launch.n_samples = 1;
  const std::uint32_t n_pixels = launch.camera.width * launch.camera.height;
  for (launch.first_pixel = 0; launch.first_pixel < n_pixels; launch.first_pixel += stages.max_paths()) {
    launch.n_pixels = std::min(std::uint32_t(stages.max_paths()), n_pixels - launch.first_pixel);
    stages.find_ground_truth(launch, settings.sees_through_glass, *on_device, film);
  }
}

RenderedFrame Renderer::Impl::read_film(int camera) const {
  const Camera& seen_by = scene.cameras[camera];
  RenderedFrame picture;
  picture.width = seen_by.width;
  picture.height = seen_by.height;
  if (settings.finds_truth) {
    picture.depth = film.depth.read();
    picture.distance = film.distance.read();
    picture.instance = film.instance.read();
    picture.normal = film.normal.read();
  }
  const double exposure = finish->denoises() ? 1 : seen_by.exposure;
  const std::vector<F32x4> sums = film.sum.read();
  picture.rgb.resize(3 * sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    // a pixel that lost all its samples is black; dropped_samples tells. What is filtered is exposed after it
    const float scale = sums[i].v[3] > 0 ? float(exposure / sums[i].v[3]) : 0.0f;
    for (int c = 0; c < 3; ++c) picture.rgb[3 * i + c] = sums[i].v[c] * scale;
  }
  for (const std::uint32_t dropped : film.dropped.read()) picture.dropped_samples += dropped;
  return picture;
}

void Renderer::Impl::read_features(RenderedFrame& picture) const {
  const auto means = [](const std::vector<F32x4>& sums) {
    std::vector<float> values;
    values.reserve(3 * sums.size());
    for (const F32x4& sum : sums)
      for (int c = 0; c < 3; ++c) values.push_back(sum.v[c] / sum.v[3]);
    return values;
  };
  picture.albedo = means(film.guides->guide_color.read());
  picture.mean_normal = means(film.guides->guide_normal.read());
}

RenderedFrame Renderer::Impl::take_picture(const Launch& launch, int camera, std::uint64_t rays) {
  if (settings.finds_truth || denoiser) {  // the built-in filter is guided by it
    find_ground_truth(launch);
    last_camera = camera;
  }
  if (launch.n_light_paths > 0) stages.add_light(launch, film);
  if (denoiser) (*denoiser)(launch.camera.width, launch.camera.height, film);
  RenderedFrame picture = read_film(camera);
  if (finish->denoises() || settings.notes_features) read_features(picture);
  picture.rays = rays;
  return picture;
}

void Renderer::Impl::check_camera_index(int camera) const {
  if (camera < 0 || camera >= int(scene.cameras.size()))
    throw UsageError("the scene has " + counted(scene.cameras.size(), "camera") + ", number " + std::to_string(camera) +
                     " was asked for");
}

std::string denoiser_name(const Device& device) {
  const std::optional<ImageDenoise> library = ImageDenoise::find(device.info().is_gpu);
  return library ? library->name() : OWN_DENOISER;
}

Renderer::Renderer(Device& device, const Scene& scene, const RenderSettings& settings)
    : impl_(std::make_unique<Impl>(device, scene, settings)) {
  set_state(initial_state(scene));
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

void Renderer::set_state(const SceneState& state) { impl_->move_to(state); }

void Renderer::set_distortion(int camera, const std::vector<double>& distortion) {
  impl_->check_camera_index(camera);
  Camera seen_by = impl_->scene.cameras[std::size_t(camera)];
  seen_by.distortion = distortion;
  check_camera(seen_by);
  impl_->scene.cameras[std::size_t(camera)] = std::move(seen_by);
}

RenderedFrame Renderer::Impl::trace(int camera, std::uint32_t frame) {
  check_camera_index(camera);
  const Camera& seen_by = scene.cameras[std::size_t(camera)];
  const std::uint32_t n_pixels = std::uint32_t(seen_by.width) * std::uint32_t(seen_by.height);
  film.begin(std::uint32_t(seen_by.width), std::uint32_t(seen_by.height));
  const Launch launch = begin_launch(camera, frame);
  const std::uint64_t rays = settings.is_adaptive ? add_adaptive_samples(launch, float(seen_by.exposure))
                                                  : add_samples(launch, film.order, 0, n_pixels, 0, settings.samples);
  return take_picture(launch, camera, rays + add_light_paths(launch, 0, settings.samples));
}

RenderedFrame Renderer::trace(int camera, std::uint32_t frame, const std::function<SceneState(double)>& at,
                              double time) {
  Impl& r = *impl_;
  r.check_camera_index(camera);
  const Camera& seen_by = r.scene.cameras[std::size_t(camera)];
  if (seen_by.exposure_time == 0 && seen_by.row_time == 0) {
    if (r.state.time != time) r.move_to(at(time));
    return r.trace(camera, frame);
  }
  r.film.begin(std::uint32_t(seen_by.width), std::uint32_t(seen_by.height));
  const std::uint64_t rays = r.add_moving_samples(camera, frame, at, time);
  return r.take_picture(r.begin_launch(camera, frame), camera, rays);
}

std::shared_ptr<PictureFinish> Renderer::finish() const { return impl_->finish; }

RenderedFrame Renderer::render(int camera, std::uint32_t frame) {
  RenderedFrame picture = impl_->trace(camera, frame);
  (*impl_->finish)(picture, camera, frame);
  return picture;
}

RenderedFrame Renderer::render(int camera, std::uint32_t frame, const std::function<SceneState(double)>& at,
                               double time) {
  RenderedFrame picture = trace(camera, frame, at, time);
  (*impl_->finish)(picture, camera, frame);
  return picture;
}

std::vector<std::uint32_t> Renderer::instances(int camera) {
  Impl& r = *impl_;
  r.check_camera_index(camera);
  const Camera& seen_by = r.scene.cameras[std::size_t(camera)];
  r.film.begin(std::uint32_t(seen_by.width), std::uint32_t(seen_by.height));
  r.find_ground_truth(r.begin_launch(camera, 0));
  r.last_camera = camera;
  return r.film.instance.read();
}

FlowFrame Renderer::flow(const SceneState& other) {
  Impl& r = *impl_;
  if (r.last_camera < 0) throw std::logic_error("flow is asked for before a picture was made");
  const SceneState here = r.state;
  const Launch from = r.begin_launch(r.last_camera, 0);
  r.move_to(other);
  const std::size_t n = r.film.seen.size();
  Buffer<float> flow(r.device, 2 * n, "flow");
  Buffer<std::uint8_t> state(r.device, n, "state");
  r.stages.find_flow(from, r.begin_launch(r.last_camera, 0), *r.on_device, r.film, flow, state);
  FlowFrame result{flow.read(), state.read()};
  r.move_to(here);
  return result;
}

Eigen::Matrix4d Renderer::camera_pose(int camera) const { return impl_->camera_poses.at(std::size_t(camera)); }

}  // namespace pvg
