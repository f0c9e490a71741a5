// Where a point is to a closed surface.
#pragma once
#include <span>

#include "host/geometry/mesh.hpp"

namespace pvg {

// How often the surface goes around p: 1 inside of a closed one, 0 outside. Van Oosterom and Strackee 1983.
double winding_number(std::span<const Vec3> points, std::span<const Triangle> triangles, const Vec3& p);

// How far p is below the closed surface, from its nearest point; 0 outside. [m]
double depth_inside(const TriangleMesh& mesh, const Vec3& p);

// Whether a way passes more than `depth` below the closed surface, or in on one side and out of the opposite one where
// those are farther apart than that. Where it begins deep inside it counts from where it no longer is.
// way: straight lines between these points [m];  depth > 0 [m]
bool passes_through(const TriangleMesh& mesh, std::span<const Vec3> way, double depth);

}  // namespace pvg
