#include "host/pictures/srgb.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {

float srgb_to_linear(float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); }
float linear_to_srgb(float c) { return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f; }

std::uint8_t srgb8_from_linear(float linear) {
  // negated, so that not-a-number is black
  if (!(linear > 0)) return 0;
  const float c = std::min(linear, 1.0f);
  const float encoded = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return std::uint8_t(std::lround(255 * encoded));
}

}  // namespace pvg
