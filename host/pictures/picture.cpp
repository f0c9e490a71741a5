#include "host/pictures/picture.hpp"

#include <algorithm>

#include "host/pictures/srgb.hpp"

namespace pvg {

Image8 encode_srgb8(std::span<const float> linear_rgb, int width, int height) {
  Image8 image{width, height, std::vector<std::uint8_t>(linear_rgb.size())};
  std::transform(linear_rgb.begin(), linear_rgb.end(), image.rgb.begin(), srgb8_from_linear);
  return image;
}

}  // namespace pvg
