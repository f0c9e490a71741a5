// Brightness of a photo, and how it changes from pixel to pixel.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "host/pictures/picture.hpp"

namespace pvg {

struct GrayPhoto {
  int width = 0, height = 0;
  std::vector<float> value;  // sRGB luma, 0 to 1 [height x width]

  // bilinear, with its slope per pixel; false: outside
  bool at(double x, double y, double& v, Eigen::Vector2d& slope) const;
};

GrayPhoto gray_of(const Picture8& picture);

// binomial filter, `rounds` times; each adds 1/2 to the variance [pixels^2]
void blur(GrayPhoto& photo, int rounds);

}  // namespace pvg
