// Plain shapes about the origin as they are seen: every face has corners and normals of its own, so edges are sharp and
// round sides are smooth. Axis z, lengths in metres. Closed surfaces for contact are in primitive_shapes.hpp.
#pragma once
#include "host/geometry/visual_mesh.hpp"

namespace pvg {

VisualMesh box_visual(const Vec3& size);
VisualMesh cylinder_visual(double radius, double length, int segments = 24);
VisualMesh sphere_visual(double radius, int segments = 24);

}  // namespace pvg
