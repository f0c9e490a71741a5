// The path tracer: a Scene's visuals, lights and cameras on a device, one picture per call.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/scene/scene.hpp"
#include "host/scene/state.hpp"

namespace pvg {

struct RenderSettings {
  int samples = 16;    // paths per pixel
  int max_depth = 12;  // bounces; a glass wall takes two
  std::uint64_t seed = 0;
  // clear glass between a light and a diffuse surface or shadow receiver attenuates the shadow ray, which goes straight
  // through, and refracted light of that light is left out; false: glass blocks shadow rays, all refracted paths count
  bool transparent_shadows = true;
};

struct RenderedFrame {
  int width = 0, height = 0;
  std::vector<float> rgb;    // linear Rec. 709, exposure applied  [height x width x 3]
  std::vector<float> depth;  // z in the camera's frame at the pixel's centre, lights included, infinite where
                             // nothing is hit [m]
  std::vector<std::uint32_t> instance;  // 1 + index of the Visual at the pixel's centre, 0: nothing or a light  [h x w]
  std::vector<float> normal;  // of the surface at the pixel's centre, unit, world, toward the camera, or 0  [h x w x 3]
  std::uint32_t dropped_samples = 0;  // samples that were not finite and were left out
  std::uint64_t rays = 0;             // path segments traced, shadow rays not counted
};

// where everything is before anything moves
SceneState initial_state(const Scene& scene);

class Renderer {
 public:
  Renderer(Device& device, const Scene& scene, const RenderSettings& settings);
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  // Moves every visual and camera to where its body is; refits what deforms.
  void set_state(const SceneState& state);
  // `frame` enters the random numbers: the same seed, frame and camera give the same bits.
  RenderedFrame render(int camera, std::uint32_t frame);
  // camera to world as of the last set_state, for the record
  Eigen::Matrix4d camera_pose(int camera) const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
