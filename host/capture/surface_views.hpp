// Meshes of a capture as cameras see them.
#pragma once
#include <optional>
#include <span>

#include "host/capture/frames.hpp"
#include "host/model/scene.hpp"
#include "host/pictures/lut.hpp"
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

// A photo and the picture of the surfaces from where it was taken.
struct PhotoView {
  int width = 0, height = 0;
  std::vector<float> photo, rendered;  // linear  [height x width x 3]
  std::vector<float> depth;            // of the surfaces at the pixel's middle, infinite: none  [height x width, m]
  std::vector<bool> is_covered;        // by the first surface  [height x width]
  std::vector<bool> is_drawn;          // by any of them  [height x width]
};

// Photos beside pictures of surfaces from any pose.
class PhotoViews {
 public:
  // All frames have photos.
  PhotoViews(Device& device, std::span<const CaptureFrame> frames, std::span<const CapturedSurface> surfaces,
             VisualMaterial::Kind kind, const RenderSettings& settings);
  // from this pose of the photo's colour camera
  PhotoView at(std::size_t frame, const Pose& camera);

 private:
  Scene scene_;  // each camera is mounted on a body of its own
  Renderer renderer_;
  std::vector<std::vector<float>> photos_;  // linear  [n_frames][height x width x 3]
};

// The table that carries the picture to the photo's exposure and white balance; none: too few pixels can be compared.
std::optional<Lut> own_lut(const PhotoView& view);
// What is not drawn stays black.
void apply_lut(const Lut& lut, PhotoView& view);

// Where the photos were taken, by the colours of the surfaces, to which they must not have contributed: each colour
// camera's pose, moved from its own by what makes the surfaces' picture most like the photo (photo_placement.cpp).
// surfaces: as shadow receivers; only what the first one covers is compared. All frames have photos. [n_frames]
std::vector<Pose> place_photos(Device& device, std::span<const CaptureFrame> frames,
                               std::span<const CapturedSurface> surfaces);

}  // namespace pvg
