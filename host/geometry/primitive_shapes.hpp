// Meshes of plain shapes, centred at the origin: what scenes need when they name no mesh file. Lengths in metres.
#pragma once
#include <array>

#include "host/geometry/mesh.hpp"

namespace pvg {

// ---- closed surfaces, facing outward ----------------------------------------------------------------------------

// `size` along the axes; each face is cut into divisions[axis] parts along its two axes, two triangles per part.
TriangleMesh box_surface(const Vec3& size, const std::array<int, 3>& divisions = {1, 1, 1});

// An icosahedron with its corners on the sphere, each triangle cut into four `subdivisions` times, all points on the
// sphere.
TriangleMesh sphere_surface(double radius, int subdivisions);

// Along z, its corners on the circle; the end faces are fans around their centres.
TriangleMesh cylinder_surface(double radius, double length, int sides);

// A cylinder along z of `length` between two half balls; `sides` corners around, sides / 4 rings on each half ball.
TriangleMesh capsule_surface(double radius, double length, int sides);

// Eight corners: four counter-clockwise seen from above, then the four above them. A UsageError if it is flat or
// inside out.
TriangleMesh hexahedron_surface(const std::array<Vec3, 8>& corners);

// ---- open surfaces ----------------------------------------------------------------------------------------------

// In the plane z = 0, facing +z.
TriangleMesh square_surface(double size);

// The same, size[0] along x and size[1] along y in divisions[0] x divisions[1] cells, all cut along the same diagonal:
// every triangle equals every other.
TriangleMesh sheet_surface(const std::array<double, 2>& size, const std::array<int, 2>& divisions);

// The same, round: 6 k points on circle k of `rings`, evenly spaced; triangles near to equilateral.
TriangleMesh disc_surface(double radius, int rings);

// ---- solids -----------------------------------------------------------------------------------------------------

// divisions[axis] equal cells along each axis, six tetrahedra per cell that share its diagonal (Kuhn 1960).
TetMesh box_solid(const Vec3& size, const std::array<int, 3>& divisions, int nodes_per_element);

// The part x, y, z >= 0 of a ball around the origin, for problems that are symmetric about all three planes: a grid of
// n x n x n cells, mapped so that the planes max(x, y, z) = const become spheres. grading: exponent of the spacing; 1:
// even, larger: cells crowd around the pole on z. The flat facets lie on the sphere on the mean, their corners outside.
TetMesh ball_octant_solid(double radius, int n, double grading, int nodes_per_element);

}  // namespace pvg
