#pragma once
#include <cstddef>
#include <span>

#include "host/geometry/mesh.hpp"

namespace pvg {

// Index of the point nearest to the place, of several as near the first. points: [n >= 1, m]
inline std::size_t nearest_point(std::span<const Vec3> points, const Vec3& place) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    if ((points[i] - place).squaredNorm() < (points[nearest] - place).squaredNorm()) nearest = i;
  return nearest;
}

}  // namespace pvg
