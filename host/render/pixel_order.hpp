// Pixels in the order of 8 x 8 tiles, so that neighbours in memory are neighbours in the picture.
#pragma once
#include <cstdint>
#include <vector>

namespace pvg {

inline constexpr std::uint32_t TILE = 8;  // [pixels]

// Places y * width + x of all pixels, [width x height]: tiles in rows from the top left one, in each its rows. Tiles at
// the right and lower border are narrower.
std::vector<std::uint32_t> tile_order(std::uint32_t width, std::uint32_t height);

}  // namespace pvg
