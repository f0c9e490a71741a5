// Points carried by a solid of tetrahedra: p = W x, each row of W the barycentric weights of a point in its
// tetrahedron.
#pragma once
#include <span>

#include "host/geometry/loop_subdivision.hpp"
#include "host/geometry/mesh.hpp"

namespace pvg {

struct Embedding {
  SparseRows weights;            // W [n_points x n_nodes], four entries in a row
  std::vector<double> distance;  // [n_points, m] from the solid, 0: inside
};

// Of points in the frame of the mesh's rest shape. A point outside is carried on linearly from the nearest tetrahedron.
// W maps a linear field of the nodes to the same field of the points, whatever the element; a 10-node element counts as
// its eight straight pieces. Throws a Failure where the mesh has no tetrahedra.
Embedding embed_points(const TetMesh& mesh, std::span<const Vec3> points);

}  // namespace pvg
