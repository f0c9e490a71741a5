// sRGB coding of linear light (IEC 61966-2-1): 12.92 c below 0.0031308, else 1.055 c^(1/2.4) - 0.055. Pure.
#pragma once
#include <cstdint>

namespace pvg {

// both in [0, 1]
float srgb_to_linear(float c);
float linear_to_srgb(float c);
// cut to [0, 1], rounded to 1/255
std::uint8_t srgb8_from_linear(float linear);

}  // namespace pvg
