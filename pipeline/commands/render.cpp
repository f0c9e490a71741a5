// phyvisgen render: pictures of a scene, or of a recorded motion.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/base/progress.hpp"
#include "host/base/stop_signal.hpp"
#include "host/dataset/truth_file.hpp"
#include "host/formats/lut_file.hpp"
#include "host/formats/picture_files.hpp"
#include "host/formats/video.hpp"
#include "host/load/overview.hpp"
#include "host/load/task_file.hpp"
#include "host/render/renderer.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/episode/motion_pictures.hpp"
#include "pipeline/episode/receiver_look.hpp"
#include "pipeline/episode/scene_gltf.hpp"
#include "pipeline/episode/shown_scene.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct RenderOptions {
  std::string scene, states;         // scene or task file, states file; empty: the start
  std::string output;                // folder, or FILE.png, .exr, .mp4; may be empty where a glTF is written
  std::string gltf;                  // .glb to write as well: the scene as the first frame shows it
  std::vector<std::string> cameras;  // names; empty: all
  std::string frames;                // A:B; empty: all
  double frames_per_second = 0;      // of states without pictures, and of videos; 0: what the file says
  int width = 0, height = 0;         // [pixels]; 0: what the file says
  int samples = 0, max_depth = 0;    // 0: what the file says
  bool caustics = false;             // glass blocks shadow rays; what it bends of a lamp's light falls on matte things
  std::uint64_t seed = 0;
  std::string lut;                   // .csv of calibrate lut; empty: what the file says
  bool writes_ground_truth = false;  // CAMERA_truth.h5 beside the pictures
  bool sees_through_glass = false;   // ground truth: of what is behind glass
  bool is_adaptive = false;
  bool denoises = false;
  std::string receivers = "kept";  // or relit, emissive
  bool is_rigid = false;           // grippers, of a task
  std::string device;
  bool is_verbose = false;
};

constexpr double FRAMES_PER_SECOND = 25;  // of scenes; tasks say theirs

enum class Target { folder, picture, video };

Target target_of(const fs::path& output) {
  const std::string suffix = output.extension().string();
  if (suffix.empty()) return Target::folder;
  if (suffix == ".png" || suffix == ".jpg" || suffix == ".exr") return Target::picture;
  if (suffix == ".mp4") return Target::video;
  if (fs::is_directory(output)) return Target::folder;
  throw UsageError("-o " + output.string() + ": the suffix must be .png, .jpg, .exr or .mp4, or name a folder");
}

std::vector<int> chosen_cameras(const Scene& scene, const std::vector<std::string>& names) {
  std::vector<int> chosen;
  std::string known;
  for (const Camera& camera : scene.cameras) known += (known.empty() ? "" : ", ") + camera.name;
  for (int i = 0; i < int(scene.cameras.size()); ++i)
    if (names.empty()) chosen.push_back(i);
  for (const std::string& name : names) {
    const auto at = std::find_if(scene.cameras.begin(), scene.cameras.end(),
                                 [&](const Camera& camera) { return camera.name == name; });
    if (at == scene.cameras.end()) throw UsageError("--camera " + name + ": the scene has the cameras " + known);
    const int camera = int(at - scene.cameras.begin());
    if (std::find(chosen.begin(), chosen.end(), camera) != chosen.end())
      throw UsageError("--camera " + name + " stands there twice; name it once");
    chosen.push_back(camera);
  }
  return chosen;
}

// a file that appears complete or not at all
void write_picture(const fs::path& file, const MotionPicture& picture) {
  PartialFile partial(file);
  if (file.extension() == ".exr")
    write_linear_picture(partial.path(), picture.linear.rgb, picture.linear.width, picture.linear.height);
  else
    write_picture(partial.path(), picture.encoded);
  partial.finish();
}

// Where pictures go: each to its file, or all into one video.
class PictureOutput {
 public:
  PictureOutput(const RenderOptions& options, double rate)
      : output_(options.output), target_(target_of(output_)), rate_(rate) {
    if (target_ == Target::folder) make_writable_folder(output_);
    if (target_ != Target::folder) check_output_file(output_);
  }

  void check(std::size_t n_cameras, std::size_t n_frames) const {
    if (target_ == Target::picture && n_cameras * n_frames > 1)
      throw UsageError("-o " + output_.string() + " is one picture, but " + counted(n_cameras, "camera") + " and " +
                       counted(n_frames, "frame") +
                       " are asked for; choose one with --camera and --frames, or name a folder or an .mp4");
    if (target_ == Target::video && n_cameras > 1)
      throw UsageError("-o " + output_.string() + " is one video, but there are " + counted(n_cameras, "camera") +
                       "; choose one with --camera");
  }

  void check_size(const Camera& camera) const {
    if (target_ == Target::video)
      check_video_size("-o " + output_.string() + ", camera " + camera.name, camera.width, camera.height);
  }

  // What there is of `done` of `all` pictures when the work was stopped.
  std::string stopped(std::size_t done, std::size_t all) const {
    return "stopped after " + std::to_string(done) + " of " + counted(all, "picture") + "; " +
           (target_ == Target::folder ? "those are complete" : output_.string() + " was not written");
  }

  void add(const MotionPicture& picture, const std::string& camera) {
    if (target_ == Target::picture) return write_picture(output_, picture);
    if (target_ == Target::folder) {
      return write_picture(output_ / fmt::format("{}_{:06}.png", camera, picture.frame), picture);
    }
    if (!video_) {
      partial_.emplace(output_);
      video_ = std::make_unique<VideoWriter>(partial_->path(), picture.encoded.width, picture.encoded.height, rate_);
    }
    video_->write(picture.encoded.rgb);
  }

  void finish() {
    if (!video_) return;
    video_->finish();
    partial_->finish();
  }

 private:
  fs::path output_;
  Target target_;
  double rate_;
  std::optional<PartialFile> partial_;
  std::unique_ptr<VideoWriter> video_;
};

void check_options(const RenderOptions& options) {
  if (options.scene.empty())
    throw UsageError("render needs a scene, task or glTF file; `phyvisgen render --help` shows an example");
  if (options.output.empty() && options.gltf.empty())
    throw UsageError("render needs an output: -o FILE.png, FILE.mp4 or a folder");
  if (options.sees_through_glass && !options.writes_ground_truth)
    throw UsageError("--through-glass is for ground truth, which nobody asked for; add --ground-truth");
}

RenderSettings settings_of(const RenderOptions& options, const ShownScene& shown) {
  RenderSettings settings = settings_of(shown.render);
  if (options.samples) settings.samples = options.samples;
  settings.transparent_shadows = !options.caustics;
  if (options.max_depth) settings.max_depth = options.max_depth;
  settings.seed = options.seed ? options.seed : shown.seed;
  settings.sees_through_glass = options.sees_through_glass;
  settings.notes_features = options.writes_ground_truth;
  settings.finds_truth = options.writes_ground_truth;
  settings.is_adaptive |= options.is_adaptive;
  settings.denoises |= options.denoises;
  return settings;
}

void tell_of(const MotionPicture& picture, const std::string& camera, bool is_verbose) {
  const RenderedFrame& frame = picture.linear;
  if (is_verbose)
    std::fprintf(stderr, "  %s, frame %zu: %d x %d pixels, %.2f million path segments, %.1f s\n", camera.c_str(),
                 picture.frame, frame.width, frame.height, double(frame.rays) * 1e-6, picture.seconds);
  if (frame.dropped_samples > 0)
    std::fprintf(
        stderr, "phyvisgen: %s, frame %zu: %s left out\n", camera.c_str(), picture.frame,
        counted(frame.dropped_samples, "sample was not finite and was", "samples were not finite and were").c_str());
}

// The ground truth of one camera: beside the pictures, complete or not at all.
class Truth {
 public:
  Truth(const fs::path& folder, const Scene& scene, const Camera& camera)
      : partial_(folder / (camera.name + "_truth.h5")), writer_(partial_.path(), scene, camera) {}
  TruthFile& writer() { return writer_; }
  void finish() {
    writer_.close();
    partial_.finish();
  }

 private:
  PartialFile partial_;
  TruthFile writer_;
};

void render_frames(const RenderOptions& options, const ShownScene& shown, const Frames& frames, FrameRange range,
                   double rate) {
  const Scene& scene = shown.scene;
  MotionSettings settings{range, chosen_cameras(scene, options.cameras), settings_of(options, shown), {}, false};
  settings.finds_flow = options.writes_ground_truth;
  const std::size_t n = settings.cameras.size() * (range.end - range.begin);
  PictureOutput pictures(options, rate);
  pictures.check(settings.cameras.size(), range.end - range.begin);
  for (const int camera : settings.cameras) pictures.check_size(scene.cameras[std::size_t(camera)]);
  const fs::path lut_file = options.lut.empty() ? shown.render.lut : fs::path(options.lut);
  if (!lut_file.empty()) settings.lut = read_lut(lut_file);
  const fs::path output(options.output),
      folder = target_of(output) == Target::folder ? output : fs::absolute(output).parent_path();
  const std::atomic<bool>& stop = stop_on_signals();
  Device device(options.device, Purpose::rendering);
  std::map<int, Truth> truths;  // by camera
  for (const int camera : settings.cameras)
    if (options.writes_ground_truth) truths.try_emplace(camera, folder, scene, scene.cameras[std::size_t(camera)]);
  Progress progress(scene.name, "pictures", n);
  std::size_t done = 0;
  const auto write = [&](const MotionPicture& picture) {
    const std::string& name = scene.cameras[std::size_t(picture.camera)].name;
    tell_of(picture, name, options.is_verbose);
    pictures.add(picture, name);
    if (const auto truth = truths.find(picture.camera); truth != truths.end())
      truth->second.writer().append(picture.linear, picture.forward, picture.backward, picture.state,
                                    picture.T_world_camera);
    progress.advance_to(++done);
  };
  try {
    render_motion(device, scene, frames, settings, write, stop);
  } catch (const TryAgain&) {
    throw TryAgain(pictures.stopped(done, n));
  }
  pictures.finish();
  for (auto& [camera, truth] : truths) truth.finish();
}

void run_render(const RenderOptions& options) {
  check_options(options);
  if (!options.output.empty()) target_of(options.output);
  ShownScene shown = load_shown_scene(options.scene, options.states, options.is_rigid);
  for (const std::string& sentence : shown.notes) std::fprintf(stderr, "phyvisgen: %s\n", sentence.c_str());
  for (const std::string& sentence : complete_for_viewing(shown.scene))
    std::fprintf(stderr, "phyvisgen: %s\n", sentence.c_str());
  show_receivers(shown.scene, options.receivers);
  for (Camera& camera : shown.scene.cameras)
    if (options.width || options.height) resize(camera, options.width, options.height);
  if (options.frames_per_second > 0 && options.states.empty())
    throw UsageError("--fps is for a motion; without --states only the start is shown");
  const double usual = shown.is_task ? shown.render.frames_per_second : FRAMES_PER_SECOND;
  const double rate = options.frames_per_second > 0 ? options.frames_per_second : usual;
  const Frames frames(shown.scene, options.states, rate);
  if (options.frames_per_second > 0 && frames.are_recorded())
    throw UsageError(fmt::format("--fps: {} has frames of its own, {:g} per second; leave --fps out", options.states,
                                 frames.rate()));
  const FrameRange range = parse_frames(options.frames, frames.size(),
                                        options.states.empty() ? options.scene + " without --states" : "the motion");
  if (!options.gltf.empty()) check_output_file(options.gltf, {".glb"}, "--export");
  if (!options.gltf.empty()) write_scene_gltf(options.gltf, shown.scene, frames.state(range.begin));
  if (!options.output.empty()) render_frames(options, shown, frames, range, frames.rate());
}

}  // namespace

void add_render(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("render", "Picture a scene, or a motion that simulate or generate recorded");
  RenderOptions& o = options_of_command(*command, run_render);
  command->add_option("SCENE", o.scene, "Scene or task file (YAML), or a glTF file (.glb, .gltf)");
  command->add_option("--states", o.states, "States file (HDF5) of that scene or task; else the start is shown");
  command->add_option("-o,--output", o.output,
                      "FILE.png, .jpg or .exr (linear), FILE.mp4, or a folder for one picture per camera and frame");
  command->add_option("--frames", o.frames, "A:B, the frames A to B - 1; or one frame");
  command->add_option("--camera", o.cameras, "Only this camera; may stand several times")->allow_extra_args(false);
  command->add_option("--samples", o.samples, "Paths per pixel; else what the file says")->check(CLI::Range(1, 65536));
  command->add_flag(
      "--caustics", o.caustics,
      "Light of lamps that glass and mirrors throw onto other things, instead of straight tinted shadows");
  command->add_option("--max-depth", o.max_depth, "Bounces; else what the file says")->check(CLI::Range(1, 1000));
  command->add_option("--width", o.width, "Of all pictures [pixels]; the field of view stays")
      ->check(CLI::Range(2, 16384));
  command->add_option("--height", o.height, "Of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command
      ->add_option("--fps", o.frames_per_second,
                   "Pictures per second of motion; else what the task says, 25 of a scene")
      ->check(CLI::Range(0.01, 1000.0));
  command->add_option("--seed", o.seed, "Of the pictures' noise");
  command->add_option("--lut", o.lut, "Lookup table of `calibrate lut` (.csv); else what the file says");
  command->add_flag("--adaptive", o.is_adaptive,
                    "More paths where the noise is, --samples is their mean; also where the file says so");
  command->add_flag("--denoise", o.denoises, "Filter the noise of few samples; also where the file says so");
  command
      ->add_option("--receivers", o.receivers,
                   "kept; relit: captured surfaces as diffuse ones below the scene's lights; emissive: without shadows")
      ->check(CLI::IsMember({"kept", "relit", "emissive"}))
      ->capture_default_str();
  command
      ->add_option_function<std::string>(
          "--gripper", [&o](const std::string& kind) { o.is_rigid = kind == "rigid"; },
          "soft, or rigid: for states that `generate --gripper rigid` recorded")
      ->check(CLI::IsMember({"soft", "rigid"}));
  command->add_flag("--ground-truth", o.writes_ground_truth,
                    "Write CAMERA_truth.h5 as well: depth, normals, instances, parts, flow, boxes, poses");
  command->add_flag("--through-glass", o.sees_through_glass, "Ground truth of what is behind glass, not of the glass");
  command->add_option("--export", o.gltf,
                      "Write the first frame's scene as binary glTF (.glb), for Blender and others");
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("-v,--verbose", o.is_verbose, "Tell of every picture: rays, time, dropped samples");
  command->footer(
      "Examples:\n  phyvisgen render data/scenes/beaker_on_scale.yaml -o beaker.png --samples 64\n"
      "  phyvisgen render data/scenes/cornell_glass.yaml -o cornell.exr --samples 1024 --caustics --adaptive\n"
      "  phyvisgen render model.glb -o model.png\n"
      "  phyvisgen render data/validation/drape.yaml --states drape.h5 -o drape.mp4 --fps 25\n"
      "  phyvisgen render data/tasks/weigh_beaker.yaml --states out/beaker/episode_000000/states.h5 --camera wrist \\\n"
      "      --frames 10:12 -o wrist\n"
      "  phyvisgen render data/tasks/weigh_beaker.yaml --receivers relit --camera front -o relit.png\n"
      "  phyvisgen render data/tasks/weigh_beaker.yaml --gripper rigid --camera front -o rigid.png");
}

}  // namespace pvg
