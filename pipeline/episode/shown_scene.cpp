#include "pipeline/episode/shown_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "host/base/error.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/overview.hpp"
#include "host/load/scene_file.hpp"
#include "host/load/task_file.hpp"
#include "host/render/motion.hpp"
#include "pipeline/episode/episode.hpp"

namespace pvg {
namespace {

std::size_t parse_frame(const std::string& part, const std::string& text) {
  std::size_t frame = 0;
  const auto parsed = std::from_chars(part.data(), part.data() + part.size(), frame);
  if (parsed.ec != std::errc() || parsed.ptr != part.data() + part.size())
    throw UsageError("--frames " + text + " is not A:B with frame numbers, such as 0:10");
  return frame;
}

bool is_gltf_file(const std::filesystem::path& file) {
  const std::string suffix = file.extension().string();
  return suffix == ".glb" || suffix == ".gltf" || suffix == ".GLB" || suffix == ".GLTF";
}

// Lights of a glTF file are in candela and lux, from a lamp's few to a sun's hundred thousand: cameras are opened for
// the sum of what they bring to the middle of what is seen.
void expose(ShownScene& shown) {
  Scene& scene = shown.scene;
  if (scene.sphere_lights.empty()) return;
  Eigen::AlignedBox3d box;
  for (const VisualMesh& mesh : scene.visual_meshes)
    for (const Vec3f& point : mesh.points) box.extend(point.cast<double>());
  double irradiance = 0;
  for (const SphereLight& light : scene.sphere_lights) {
    const double distance = std::max(light.radius, (light.center - box.center()).norm());
    irradiance += std::numbers::pi * std::pow(light.radius / distance, 2) * double(light.radiance.maxCoeff());
  }
  if (!(irradiance > 0)) return;
  const double exposure = std::numbers::pi / irradiance;
  for (const std::string& sentence : complete_for_viewing(scene)) shown.notes.push_back(sentence);
  for (Camera& camera : scene.cameras) camera.exposure = float(exposure);
  shown.notes.push_back(fmt::format(
      "its lights bring {:.4g} lux to its middle: pictures are exposed by the factor {:.4g}", irradiance, exposure));
}

}  // namespace

ShownScene load_shown_scene(const std::string& file, const std::string& states, bool has_rigid_grippers) {
  ShownScene shown;
  if (has_rigid_grippers && (is_gltf_file(file) || !is_task_file(file)))
    throw UsageError("--gripper rigid: " + file + " is no task; only tasks have grippers");
  if (is_gltf_file(file)) {
    if (!states.empty()) throw UsageError("--states " + states + ": nothing moves in a glTF file such as " + file);
    shown.scene = gltf_as_scene(file, &shown.notes);
    expose(shown);
  } else if (is_task_file(file)) {
    shown.is_task = true;
    Task task = load_task(file);
    if (has_rigid_grippers) make_grippers_rigid(task);
    shown.render = task.render;
    if (states.empty()) {
      shown.scene = build_scene_at_middle(task).scene;
    } else {
      const StatesOrigin origin = states_origin(states);
      if (origin.name != task.name)
        throw UsageError(states + " was made of `" + origin.name + "`, " + file + " is `" + task.name + "`");
      shown.scene = build_scene(task, origin.seed, origin.episode).scene;
      shown.seed = origin.seed;
    }
  } else {
    const SceneFile scene = load_scene_file(file);
    shown.render = scene.task.render;
    shown.scene = load_scene_run(file).scene;
  }
  return shown;
}

RenderSettings settings_of(const RenderSection& section) {
  RenderSettings settings;
  settings.samples = section.samples;
  settings.is_adaptive = section.adaptive;
  settings.max_depth = section.max_depth;
  settings.denoises = section.denoise;
  return settings;
}

void resize(Camera& camera, int width, int height) {
  const int w = width ? width : camera.width, h = height ? height : camera.height;
  const double scale = double(h) / camera.height;
  camera.fx *= scale;
  camera.fy *= scale;
  camera.cx = (camera.cx + 0.5 - camera.width / 2.0) * scale + w / 2.0 - 0.5;
  camera.cy = (camera.cy + 0.5 - camera.height / 2.0) * scale + h / 2.0 - 0.5;
  camera.width = w;
  camera.height = h;
}

double shutter_of(const Camera& camera) { return camera.exposure_time + (camera.height - 1) * camera.row_time; }

Frames::Frames(const Scene& scene, const std::string& states, double rate) : start_(initial_state(scene)), rate_(rate) {
  if (states.empty()) {
    times_ = {0};
    return;
  }
  states_.emplace(states, scene);
  for (const std::size_t step : states_->filmed_steps()) times_.push_back(states_->time(step));
  are_recorded_ = !times_.empty();
  if (times_.size() > 1) rate_ = double(times_.size() - 1) / (times_.back() - times_.front());
  if (are_recorded_) return;
  const double first = states_->time(0), last = states_->time(states_->n_steps() - 1);
  for (std::size_t i = 0; double(i) / rate <= last - first + 1e-9; ++i) times_.push_back(first + double(i) / rate);
}

std::vector<SceneState> Frames::motion(double begin, double end) const {
  if (!states_) return {start_};
  std::vector<double> times;
  for (std::size_t step = 0; step < states_->n_steps(); ++step) times.push_back(states_->time(step));
  const auto not_after = std::size_t(std::ranges::upper_bound(times, begin) - times.begin()),
             before_end = std::size_t(std::ranges::lower_bound(times, end) - times.begin());
  const std::size_t first = std::max<std::size_t>(not_after, 1) - 1, last = std::min(before_end, times.size() - 1);
  std::vector<SceneState> states;
  for (std::size_t step = first; step <= last; ++step) states.push_back(states_->state(step));
  return states;
}

SceneState Frames::at(double time) const { return state_at(motion(time, time), time); }

FrameRange parse_frames(const std::string& text, std::size_t n, const std::string& whose) {
  if (text.empty()) return {0, n};
  FrameRange range;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    range.begin = parse_frame(text, text);
    range.end = range.begin + 1;
  } else {
    const std::string first = text.substr(0, colon), last = text.substr(colon + 1);
    range.begin = first.empty() ? 0 : parse_frame(first, text);
    range.end = last.empty() ? n : parse_frame(last, text);
  }
  if (range.begin >= range.end || range.end > n)
    throw UsageError("--frames " + text + ": " + whose + " has the frame" +
                     (n == 1 ? " 0 alone" : "s 0 to " + std::to_string(n - 1)) + "; A:B are those from A to B - 1");
  return range;
}

}  // namespace pvg
