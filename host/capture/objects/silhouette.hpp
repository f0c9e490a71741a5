// The rays that just touch a thing: those through the outline of its mask.
#pragma once
#include <span>

#include "host/capture/frames.hpp"
#include "host/device/device.hpp"
#include "host/formats/picture_files.hpp"

namespace pvg {

struct TouchingRay {
  Vec3 origin, direction;  // in the capture's frame [m], [unit]
  double pixels = 0;       // focal length: by how many pixels an angle of one radian moves a point of the picture
  std::size_t view = 0;    // index of the photo
};

// Where the mask changes between two neighbouring pixels, the middle between them [pixels]; not along the picture's
// edge, which cuts the thing. Pure.
std::vector<Eigen::Vector2d> outline_of(const Mask8& mask);

// At most `most` rays of a view, evenly along the scan of its mask (kernels/capture/rays.cl). A UsageError names a mask
// that is empty, full, or of another size than its camera.
std::vector<TouchingRay> touching_rays(Device& device, std::span<const MaskedView> views, std::size_t most);

}  // namespace pvg
