// Tetrahedral meshes: their boundary, their volumes, and the step from 4 to 10 nodes.
#pragma once
#include "host/geometry/mesh.hpp"

namespace pvg {

// Boundary of a mesh: faces that belong to one element only, facing outward, in the order of the elements. A face of a
// 10-node element becomes four triangles (three at its corners, one between its midpoints).
std::vector<Triangle> boundary_triangles(const TetMesh& mesh);

// 4-node elements become 10-node ones by a node in the middle of each edge. The old nodes keep their numbers, the new
// ones follow in the order in which the elements first name them. The surface is made anew.
TetMesh make_quadratic(const TetMesh& linear);

// The straight 4-node elements that a mesh consists of, of the same points: of a 10-node element the eight pieces that
// its midpoints make, the octahedron in the middle cut along its shortest diagonal. The surface stays.
TetMesh straight_pieces(const TetMesh& mesh);

// Each 4-node element becomes eight of the same shape as nearly as may be, by the midpoints of its edges; the
// octahedron in the middle is cut along its shortest diagonal. The shape of the body stays.
TetMesh refine(const TetMesh& linear);

// Signed volume of each element's straight tetrahedron [n_elements, m^3]
std::vector<double> element_volumes(const TetMesh& mesh);

// Mass of each node [n_points, kg]: each element's mass shared in proportion to the diagonal of its consistent mass
// matrix (Hinton, Rock & Zienkiewicz 1976), so that all are positive and their sum is exact. A 4-node element gives 1/4
// to each node, a 10-node one 1/36 to each corner and 4/27 to each midpoint.
std::vector<double> node_masses(const TetMesh& mesh, double density);

}  // namespace pvg
