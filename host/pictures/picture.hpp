// Pictures as they lie in memory. Pure.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace pvg {

struct Texture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // sRGB, row 0 on top  [height x width x 4]
};

// 8 bits per channel, sRGB, row 0 on top.
struct Picture8 {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // [height x width x 3]
};

// linear_rgb: Rec. 709, cut to [0, 1]  [height x width x 3]
Picture8 encode_srgb8(std::span<const float> linear_rgb, int width, int height);

// What is seen where no surface is, as a picture: longitude along its width, z up at the top, +x in the middle, +y to
// the left. Empty: the same everywhere.
struct EnvironmentMap {
  int width = 0, height = 0;
  std::vector<float> rgb;  // linear  [height x width x 3]
  double turn = 0;         // about z, counter-clockwise seen from above [rad]
};

}  // namespace pvg
