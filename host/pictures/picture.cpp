#include "host/pictures/picture.hpp"

#include <algorithm>

#include "host/pictures/srgb.hpp"

namespace pvg {

Picture8 encode_srgb8(std::span<const float> linear_rgb, int width, int height) {
  Picture8 picture{width, height, std::vector<std::uint8_t>(linear_rgb.size())};
  std::transform(linear_rgb.begin(), linear_rgb.end(), picture.rgb.begin(), srgb8_from_linear);
  return picture;
}

}  // namespace pvg
