// Colours of the surface from the capture's photos, and where the colour camera is beside the depth camera.
#pragma once
#include <span>

#include "host/capture/frames.hpp"
#include "host/device/device.hpp"
#include "host/geometry/mesh.hpp"

namespace pvg {

struct SurfaceColors {
  std::vector<Vec3f> colors;  // [n] linear Rec. 709; of points that no photo sees those of their neighbours
  std::size_t n_seen = 0;     // points that a photo sees
};

// Means over the photos of `frames` (kernels/capture/colors.cl). normals [n], triangles for the neighbours.
SurfaceColors color_surface(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                            const std::vector<Vec3f>& points, const std::vector<Vec3f>& normals,
                            const std::vector<Triangle>& triangles, double voxel);

// The colour camera's pose in the depth camera's frame and its focal length.
struct ColorOffset {
  Pose pose = Pose::Identity();                            // colour camera to depth camera
  double focal_scale = 1;                                  // of the focal length that the files give
  double disagreement_before = 0, disagreement_after = 0;  // root mean square of the photos about their mean, in sRGB
  std::size_t n_points = 0;
};

// Minimises how much photos disagree on the brightness of the surface's points (Zhou and Koltun 2014, with one camera
// for all photos) by Gauss-Newton from coarse to fine. A UsageError where too few points are seen twice.
ColorOffset align_color_camera(const Capture& capture, std::span<const CaptureFrame> frames,
                               const std::vector<Vec3f>& points, const std::vector<Vec3f>& normals, double voxel);

// The frames with the colour camera there.
void apply_color_offset(const ColorOffset& offset, std::span<CaptureFrame> frames);

}  // namespace pvg
