// Meshes of a capture as cameras see them.
#pragma once
#include <span>

#include "host/capture/frames.hpp"
#include "host/model/scene.hpp"
#include "host/render/renderer.hpp"

namespace pvg {

// All surfaces with materials of this kind, and these cameras.
Scene scene_of(std::span<const CapturedSurface> surfaces, VisualMaterial::Kind kind, std::span<const Camera> cameras);

// Depth at the middle of every pixel, 0: nothing is there.
class SurfaceViews {
 public:
  SurfaceViews(Device& device, std::span<const VisualMesh> meshes, std::span<const Camera> cameras);
  DepthPicture depth(std::size_t camera);

 private:
  Scene scene_;
  Renderer renderer_;
};

}  // namespace pvg
