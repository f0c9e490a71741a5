// Both meshes of an object as the path tracer shows them, side by side from the same direction: what is seen on the
// left, what is simulated on the right, with flat facets.
#pragma once
#include "host/capture/objects/object.hpp"
#include "host/pictures/picture.hpp"

namespace pvg {

Picture8 picture_of_meshes(Device& device, const VisualMesh& visual, const TriangleMesh& simulation);

// The visual mesh from two opposite sides, each triangle in the colour of the wall below it, as the simulation mesh has
// it (thickness.hpp): red where it is thinner than `reach`, the distance of contact [m], then from yellow to blue at a
// hundred times that, by the logarithm. A scale in millimetres stands beside.
Picture8 picture_of_thickness(Device& device, const VisualMesh& visual, const TriangleMesh& simulation, double reach);

}  // namespace pvg
