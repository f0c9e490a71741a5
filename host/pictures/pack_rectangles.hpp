// Rectangles side by side in one picture. Pure.
#pragma once
#include <array>
#include <span>
#include <vector>

namespace pvg {

struct PackedRectangles {
  int width = 0, height = 0;                // of the picture
  std::vector<std::array<int, 2>> corners;  // [n] upper left corner of each
};

// sizes [n] width and height. In rows, the tallest first; the picture is about as wide as high. A Failure where it
// would have more than `most` pixels along an edge.
PackedRectangles pack_rectangles(std::span<const std::array<int, 2>> sizes, int most);

}  // namespace pvg
