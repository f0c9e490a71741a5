// How well shaped tetrahedra are. Pure.
#pragma once
#include "host/geometry/mesh.hpp"

namespace pvg {

struct TetQuality {
  double least_dihedral = 0;       // angle between two faces [rad]; a regular tetrahedron has 1.231 (70.5 degrees)
  double largest_radius_edge = 0;  // radius of the circumsphere over the shortest edge; regular: 0.612
  std::size_t n_slivers = 0;       // elements with a dihedral angle below SLIVER
};

constexpr double SLIVER = 0.0873;  // [rad], 5 degrees

// Of the straight tetrahedra of the corners.
TetQuality tet_quality(const TetMesh& mesh);

}  // namespace pvg
