// What is added to the colours of charts so that no step is seen where two of them meet. Pure.
#pragma once
#include <span>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

// A corner of a chart: a point of the surface as one photo shows it.
struct ChartCorner {
  std::uint32_t point = 0;
  Vec3f color = Vec3f::Zero();
  bool is_seen = false;  // by a photo; other corners keep their colour and demand nothing
};

// corners: of all charts, a point once for each chart that it belongs to; triangles: indices into corners, each of one
// chart. [n_corners] additions g that minimise
//   sum over seen corners a, b of one point (f_a + g_a - f_b - g_b)^2 + 0.1 sum over edges of triangles (g_i - g_j)^2
//   + 0.001 sum g^2                                                              (Lempitsky and Ivanov 2007)
std::vector<Vec3f> level_seams(std::span<const ChartCorner> corners, std::span<const Triangle> triangles);

}  // namespace pvg
