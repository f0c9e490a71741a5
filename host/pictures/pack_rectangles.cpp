#include "host/pictures/pack_rectangles.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/base/error.hpp"

namespace pvg {

PackedRectangles pack_rectangles(std::span<const std::array<int, 2>> sizes, int most) {
  PackedRectangles out;
  out.corners.resize(sizes.size());
  double area = 0;
  for (const auto& [width, height] : sizes) {
    area += double(width) * height;
    out.width = std::max(out.width, width);
  }
  out.width = std::max(out.width, int(std::ceil(std::sqrt(area))));
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return sizes[a][1] > sizes[b][1]; });
  int x = 0, y = 0;
  for (const std::size_t i : order) {
    const auto& [width, height] = sizes[i];
    if (x + width > out.width) {
      x = 0;
      y = out.height;
    }
    out.corners[i] = {x, y};
    x += width;
    out.height = std::max(out.height, y + height);
  }
  if (std::max(out.width, out.height) > most)
    throw Failure("a texture of " + std::to_string(out.width) + " x " + std::to_string(out.height) +
                  " pixels would be needed, more than " + std::to_string(most) +
                  " along an edge; take fewer or smaller photos");
  return out;
}

}  // namespace pvg
