// Closed surfaces of several parts, such as a cup modelled as a wall and a handle.
#pragma once
#include "host/geometry/mesh.hpp"

namespace pvg {

// Whether two parts share space that would count twice in the mass. Found by points just below the surface of one part
// that lie inside another (their winding number), so that an overlap far smaller than the triangles may be missed.
bool has_overlapping_parts(const TriangleMesh& mesh);

}  // namespace pvg
