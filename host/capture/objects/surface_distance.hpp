// How far two surfaces are apart. Pure.
#pragma once
#include "host/capture/objects/nearest_triangle.hpp"

namespace pvg {

// Distances of points spread over `from` (its points, the middles of its triangles, and of larger triangles a grid of a
// hundredth of the size) to `to` [m], ascending.
std::vector<double> surface_distances(const TriangleMesh& from, const TriangleMesh& to);
std::vector<double> surface_distances(const TriangleMesh& from, const NearestTriangle& to);

}  // namespace pvg
