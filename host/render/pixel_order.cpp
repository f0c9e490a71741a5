#include "host/render/pixel_order.hpp"

#include <algorithm>

namespace pvg {

std::vector<std::uint32_t> tile_order(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint32_t> places;
  places.reserve(std::size_t(width) * height);
  for (std::uint32_t y0 = 0; y0 < height; y0 += TILE)
    for (std::uint32_t x0 = 0; x0 < width; x0 += TILE)
      for (std::uint32_t y = y0; y < std::min(y0 + TILE, height); ++y)
        for (std::uint32_t x = x0; x < std::min(x0 + TILE, width); ++x) places.push_back(y * width + x);
  return places;
}

}  // namespace pvg
