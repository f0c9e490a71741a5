#include "host/render/image.hpp"

#include <algorithm>
#include <cmath>

#include "host/render/look.hpp"

namespace pvg {

std::vector<std::uint8_t> to_srgb8(const RenderedFrame& frame) {
  std::vector<std::uint8_t> bytes(frame.rgb.size());
  std::transform(frame.rgb.begin(), frame.rgb.end(), bytes.begin(), [](float linear) {
    return std::uint8_t(std::lround(255.0f * linear_to_srgb(std::clamp(linear, 0.0f, 1.0f))));
  });
  return bytes;
}

}  // namespace pvg
