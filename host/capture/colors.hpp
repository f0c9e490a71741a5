// Colours of the surface from the capture's photos, and where the colour camera is beside the depth camera.
#pragma once
#include <functional>
#include <span>

#include "host/capture/frames.hpp"
#include "host/device/device.hpp"
#include "host/geometry/mesh.hpp"

namespace pvg {

struct SurfaceColors {
  std::vector<Vec3f> colors;  // [n] linear Rec. 709; of points that no photo sees those of their neighbours
  std::size_t n_seen = 0;     // points that a photo sees
};

// Photos, and what their cameras see of the surface: depths [n_frames], of the colour cameras' sizes. gains [n_frames]
// multiply the photos' linear colours (exposure.hpp). Frames without photo count for nothing.
struct Photos {
  std::span<const CaptureFrame> frames;
  std::span<const DepthPicture> depths;
  std::span<const Vec3f> gains;
};

// Means over the photos (kernels/capture/colors.cl). normals [n], triangles for the neighbours. tolerance: difference
// of depth at 1 m from which a point counts as hidden [m].
SurfaceColors color_surface(Device& device, const Photos& photos, const std::vector<Vec3f>& points,
                            const std::vector<Vec3f>& normals, const std::vector<Triangle>& triangles,
                            double tolerance);

// What one photo shows of a point: linear colour, and a weight that is larger where it was near and looked straight on.
struct SeenColor {
  Vec3f color = Vec3f::Zero();
  float weight = 0;  // 0: not seen
};
// Calls `use` for each photo after the other, blurred by so many rounds of a binomial filter. seen [n_points]; of
// `photos` without gains the colours are those of the files.
void see_points(Device& device, const Photos& photos, const std::vector<Vec3f>& points,
                const std::vector<Vec3f>& normals, double tolerance, int blur,
                const std::function<void(std::size_t photo, const std::vector<SeenColor>& seen)>& use);

// The gains by which the photos agree on points of the surface; those of `photos` are not used. [n_frames]
std::vector<Vec3f> estimate_gains(Device& device, const Photos& photos, const std::vector<Vec3f>& points,
                                  const std::vector<Vec3f>& normals, double tolerance);

// The colour camera's pose in the depth camera's frame, its focal length and principal point.
struct ColorOffset {
  Pose pose = Pose::Identity();                            // colour camera to depth camera
  double focal_scale = 1;                                  // of the focal length that the files give
  double center[2] = {0, 0};                               // added to the principal point of the files [pixels]
  std::vector<Pose> photo_poses;                           // [n_frames] of each photo by itself, close to `pose`
  double disagreement_before = 0, disagreement_after = 0;  // root mean square of the photos about their mean, in sRGB
  double disagreement_moved = 0;                           // with photo_poses, of photos blurred by a pixel
  std::size_t n_points = 0;
};

// Minimises how much photos disagree on the brightness of the surface's points (Zhou and Koltun 2014, with one camera
// for all photos) by Gauss-Newton from coarse to fine. A UsageError where too few points are seen twice.
ColorOffset align_color_camera(const Capture& capture, std::span<const CaptureFrame> frames,
                               const std::vector<Vec3f>& points, const std::vector<Vec3f>& normals, double voxel);

// The frames with the colour camera there: with each photo's own pose where they are the frames that were aligned,
// else with `pose`.
void apply_color_offset(const ColorOffset& offset, std::span<CaptureFrame> frames, bool are_aligned);

}  // namespace pvg
