#include "host/identify/sensing/video_sight.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/data/resolve.hpp"
#include "host/render/camera.hpp"
#include "host/render/sensor.hpp"

namespace pvg::diagnose {
namespace {

constexpr std::uint64_t SEED = 0x766964656f;  // others than of recordings that `render` made
constexpr std::size_t MOST_KEPT = 1 << 26;    // numbers of 4 bytes

RenderSettings settings_of(const Problem& problem) {
  RenderSettings settings;
  settings.seed = SEED;
  settings.max_depth = problem.render.max_depth;
  int most_pixels = 1;
  for (const VideoSource& video : problem.recording.video_sources) {
    const Camera& camera = problem.seen.cameras[std::size_t(index_named(problem.seen.cameras, video.camera))];
    most_pixels = std::max(most_pixels, camera.width * camera.height);
  }
  settings.samples = std::clamp(criteria().video_n_paths / most_pixels, 1, criteria().video_samples_most);
  return settings;
}

// effects behind the lens are applied to the traced light (cells_of)
Scene without_sensors(Scene scene) {
  for (Camera& camera : scene.cameras) {
    camera.vignetting.clear();
    camera.full_well = camera.read_noise = 0;
  }
  return scene;
}

// all that a picture depends on
std::vector<double> key_of(int camera, const SceneState& state, int frame, double k1) {
  std::vector<double> key = {double(camera), double(frame), k1};
  for (const AffineMap& map : state.rigid) key.insert(key.end(), map.data(), map.data() + map.size());
  for (const auto* bodies : {&state.soft, &state.cloth})
    for (const std::vector<Vec3>& points : *bodies)
      for (const Vec3& point : points) key.insert(key.end(), point.data(), point.data() + 3);
  return key;
}

}  // namespace

VideoSight::VideoSight(Device& device, const Problem& problem)
    : problem_(&problem), renderer_(device, without_sensors(problem.seen), settings_of(problem)) {
  for (const VideoSource& video : problem.recording.video_sources)
    cameras_.push_back(index_named(problem.seen.cameras, video.camera));
}

const std::vector<float>& VideoSight::light_of(int camera, const SceneState& state, int frame, double k1) {
  std::vector<double> key = key_of(camera, state, frame, k1);
  const auto known = light_.find(key);
  if (known != light_.end()) return known->second;
  renderer_.set_distortion(camera, distortion_with(problem_->seen.cameras[std::size_t(camera)], k1));
  renderer_.set_state(state);
  ++n_rendered_;
  std::vector<float> light = renderer_.render(camera, std::uint32_t(frame)).rgb;
  if (n_kept_ > MOST_KEPT) {
    light_.clear();
    n_kept_ = 0;
  }
  n_kept_ += 2 * key.size() + light.size();
  return light_.emplace(std::move(key), std::move(light)).first->second;
}

PictureCells VideoSight::cells_of(int number, std::vector<float> light, const CameraError& error) const {
  Camera camera = problem_->seen.cameras[std::size_t(number)];
  if (camera.vignetting.empty()) camera.vignetting = {0};
  camera.vignetting[0] += error.v1;
  camera.full_well = camera.read_noise = 0;
  expose_sensor(camera, 0, light);
  for (float& value : light) value *= float(error.gain);
  if (problem_->lut) apply_lut(*problem_->lut, light);
  return cell_luminance(light, camera.width, camera.height);
}

PictureCells VideoSight::look(std::size_t source, const SceneState& state, int frame, const CameraError& error) {
  const int number = camera(source);
  return cells_of(number, light_of(number, state, frame, error.k1), error);
}

PictureCells VideoSight::noise(std::size_t source, const SceneState& state) {
  const int number = camera(source);
  renderer_.set_distortion(number, problem_->seen.cameras[std::size_t(number)].distortion);
  renderer_.set_state(state);
  const std::uint32_t n = criteria().video_n_noise;
  PictureCells sum{}, squares{};
  for (std::uint32_t frame = 1; frame <= n; ++frame) {
    const PictureCells cells = cells_of(number, renderer_.render(number, frame).rgb, {});
    for (std::size_t i = 0; i < cells.size(); ++i) {
      sum[i] += cells[i];
      squares[i] += cells[i] * cells[i];
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i)
    squares[i] = std::sqrt(std::max(0.0, squares[i] - sum[i] * sum[i] / n) / (n - 1));
  return squares;
}

void add_noise_of_pictures(VideoSight& sight, Problem& problem) {
  const SceneState start = initial_state(problem.seen);
  for (std::size_t source = 0; source < problem.recording.video_sources.size(); ++source) {
    const PictureCells noise = sight.noise(source, start);
    for (Channel& channel : problem.channels)
      if (channel.sensor == &video_sensor && channel.source == int(source))
        channel.sigma = std::hypot(channel.sigma, noise[std::size_t(channel.part)]);
  }
}

}  // namespace pvg::diagnose
