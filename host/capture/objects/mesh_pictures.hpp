// Both meshes of an object as the path tracer shows them, side by side from the same direction: what is seen on the
// left, what is simulated on the right, with flat facets.
#pragma once
#include "host/capture/objects/object.hpp"
#include "host/pictures/picture.hpp"

namespace pvg {

Picture8 picture_of_meshes(Device& device, const VisualMesh& visual, const TriangleMesh& simulation);

}  // namespace pvg
