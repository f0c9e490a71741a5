// Linear pictures to 8-bit sRGB. Pure.
#pragma once
#include <cstdint>
#include <vector>

#include "host/render/renderer.hpp"

namespace pvg {

// [height x width x 3]; what is brighter than 1 is white
std::vector<std::uint8_t> to_srgb8(const RenderedFrame& frame);

}  // namespace pvg
