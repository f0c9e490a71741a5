// Where a point is to a closed surface.
#pragma once
#include <span>

#include "host/geometry/mesh.hpp"

namespace pvg {

// How often the surface goes around p: 1 inside of a closed one, 0 outside. Van Oosterom and Strackee 1983.
double winding_number(std::span<const Vec3> points, std::span<const Triangle> triangles, const Vec3& p);

// How far p is below the closed surface, from its nearest point; 0 outside. [m]
double depth_inside(const TriangleMesh& mesh, const Vec3& p);

}  // namespace pvg
