// The path tracer: a Scene's visuals, lights and cameras on a device, one picture per call.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/model/scene.hpp"
#include "host/model/state.hpp"
#include "host/pictures/rendered_frame.hpp"

namespace pvg {

struct RenderSettings {
  int samples = 16;  // paths per pixel
  bool is_adaptive =
      false;           // `samples` is the mean: more where the noise is, see adaptive.hpp; not where a shutter moves
  int max_depth = 12;  // bounces; a glass wall takes two, light along one is followed (kernels/render/leave_glass.cl)
  std::uint64_t seed = 0;
  // clear glass between a light and a diffuse surface or shadow receiver attenuates the shadow ray, which goes straight
  // through, and refracted light of that light is left out; false: glass blocks shadow rays, all refracted paths count
  bool transparent_shadows = true;
  bool denoises = false;            // by Open Image Denoise where it is found, else by an edge-avoiding filter
  bool notes_features = false;      // albedo and mean_normal of the frames
  bool finds_truth = true;          // depth, distance, instance and normal of the frames, and flow
  bool sees_through_glass = false;  // depth, normals, instances and flow: of what is behind glass
  bool is_wavefront = false;        // each stage is a launch, as always on a GPU; on a CPU slower, for tests
};

// where everything is before anything moves
SceneState initial_state(const Scene& scene);

// stands in for Open Image Denoise where that is not found; less good, see docs/theory/rendering.md
inline constexpr const char* OWN_DENOISER = "the built-in filter";

// what filters the noise on this device: the library with its version, or OWN_DENOISER
std::string denoiser_name(const Device& device);

class PictureFinish;

class Renderer {
 public:
  Renderer(Device& device, const Scene& scene, const RenderSettings& settings);
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  // Moves every visual and camera to where its body is; refits what deforms.
  void set_state(const SceneState& state);
  // Camera::distortion of all that is rendered from now on; nothing else is made anew.
  void set_distortion(int camera, const std::vector<double>& distortion);
  // `frame` enters the random numbers: the same seed, frame and camera give the same bits. A camera with an exposure
  // time or a rolling shutter sees everything stand still.
  RenderedFrame render(int camera, std::uint32_t frame);
  // The same of a motion: `at` says where everything is at a time [s], the picture's is `time`, at which the shutter
  // closes (of a rolling one the last row's). Ground truth is that of `time`.
  RenderedFrame render(int camera, std::uint32_t frame, const std::function<SceneState(double)>& at, double time);
  // The light alone, neither filtered by Open Image Denoise nor exposed where it is, without the sensor's noise:
  // finish() makes it what render() gives, and may be at work while the next picture is traced.
  RenderedFrame trace(int camera, std::uint32_t frame, const std::function<SceneState(double)>& at, double time);
  std::shared_ptr<PictureFinish> finish() const;
  // What is at the middle of each pixel, as RenderedFrame::instance; no light is followed.
  std::vector<std::uint32_t> instances(int camera);
  // of the picture made last, to the same camera's picture of another state
  FlowFrame flow(const SceneState& other);
  // camera to world as of the last set_state, for the record
  Eigen::Matrix4d camera_pose(int camera) const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
