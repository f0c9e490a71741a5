// The surface of a capture after fusion: parts that float are removed, fewer triangles where asked. Pure.
#pragma once
#include "host/capture/fusion.hpp"
#include "host/geometry/visual_mesh.hpp"

namespace pvg {

// Points that no triangle uses, and triangles without area, go.
FusedSurface without_unused(const FusedSurface& surface);

// Whether a triangle belongs to a connected part whose triangles together have at least least_area [m^2].
std::vector<bool> in_large_pieces(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles,
                                  double least_area);

// Without the connected parts whose triangles together have less than least_area [m^2].
FusedSurface without_small_pieces(const FusedSurface& surface, double least_area);

// Unit normals at the points, means of their triangles weighted by area  [n]
std::vector<Vec3f> point_normals(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles);

// At most n_triangles, or as few as the error allows: quadric error metric of meshoptimizer, no point further than
// about `error` [m] from where the surface was. Where the library is missing a UsageError says so.
VisualMesh simplified(const VisualMesh& mesh, std::size_t n_triangles, double error);

struct EdgeCounts {
  std::size_t boundary = 0, crowded = 0;  // edges with one, with more than two triangles
};
EdgeCounts count_edges(const std::vector<Triangle>& triangles);

double surface_area(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles);  // [m^2]

}  // namespace pvg
