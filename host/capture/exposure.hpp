// What exposure and white balance did to each photo of a capture: one gain per photo and channel, estimated jointly
// from the points that several photos see. Pure.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

struct ColorSample {
  std::uint32_t point, photo;
  Vec3f color;  // linear Rec. 709, neither black nor saturated
};

// [n_photos] factors that make the photos agree: log gain + log color of a point's samples are to have one median, so
// that misplaced samples and highlights do not count; the logarithms of all photos' gains sum to 0. A photo without
// samples, or whose points no other photo sees, keeps 1.
std::vector<Vec3f> exposure_gains(std::span<const ColorSample> samples, std::size_t n_points, std::size_t n_photos);

}  // namespace pvg
