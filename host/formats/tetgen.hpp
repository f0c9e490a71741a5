// Tetrahedra inside a closed surface, by the program `tetgen` (Si 2015), found on the PATH. The same surface and
// options give the same mesh.
#pragma once
#include <string>

#include "host/geometry/mesh.hpp"

namespace pvg {

struct TetgenOptions {
  double max_volume = 0;           // of a tetrahedron [m^3]; 0: none
  double radius_edge_ratio = 1.6;  // bound on circumradius to shortest edge; 0: no quality refinement
  bool keeps_surface = true;       // no vertices are added on the surface
  int nodes_per_element = 10;      // 4 or 10
  double least_dihedral = 0;       // that is aimed at [degrees]; 0: TetGen's own
  double largest_dihedral = 0;     // beyond which flips and smoothing are tried at the end [degrees]; 0: TetGen's own
};

// name: the body or file, for messages. The surface's points come first and in order. Failure if `tetgen` cannot be run
// or makes nothing of the surface.
TetMesh tetrahedralize(const TriangleMesh& surface, const TetgenOptions& options, const std::string& name);

}  // namespace pvg
