// Sheets of cloth for tests.
#pragma once
#include "host/model/physical_scene.hpp"

namespace pvg {

enum class ClothGrid { right, alternating, irregular };

// n_x x n_y cells of edge `size` [m] in the plane z = 0, corner at the origin, normal +z. right: every cell is cut
// along the same diagonal; alternating: along both in turn; irregular: as right, with inner points moved by up to 0.3
// of the edge, the same on every run.
inline Cloth cloth_sheet(ClothGrid kind, std::uint32_t n_x, std::uint32_t n_y, double size) {
  Cloth cloth;
  cloth.name = "sheet";
  std::uint32_t state = 1;
  const auto uniform = [&] {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) / double(1 << 24) * 2 - 1;
  };
  for (std::uint32_t j = 0; j <= n_y; ++j)
    for (std::uint32_t i = 0; i <= n_x; ++i) {
      Vec3 point(i * size, j * size, 0);
      if (kind == ClothGrid::irregular && i > 0 && j > 0 && i < n_x && j < n_y) {
        point.x() += 0.3 * size * uniform();
        point.y() += 0.3 * size * uniform();
      }
      cloth.mesh.points.push_back(point);
    }
  for (std::uint32_t j = 0; j < n_y; ++j)
    for (std::uint32_t i = 0; i < n_x; ++i) {
      const std::uint32_t a = i + (n_x + 1) * j, b = a + 1, c = b + n_x + 1, d = a + n_x + 1;
      if (kind == ClothGrid::alternating && (i + j) % 2 == 1) {
        cloth.mesh.triangles.push_back({a, b, d});
        cloth.mesh.triangles.push_back({b, c, d});
      } else {
        cloth.mesh.triangles.push_back({a, b, c});
        cloth.mesh.triangles.push_back({a, c, d});
      }
    }
  return cloth;
}

}  // namespace pvg
