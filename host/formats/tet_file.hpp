// Tetrahedra in a file: Gmsh's MSH 2.2 as text, which other programs of finite elements read, too.
#pragma once
#include <filesystem>

#include "host/geometry/mesh.hpp"

namespace pvg {

// The straight tetrahedra of 4 nodes.
std::string tetrahedra_text(const TetMesh& mesh);

// Elements of other kinds, such as triangles of the boundary, are passed over. A UsageError names the file: where it is
// none, names a point that is not there, or holds an element without volume. Those that are turned inside out are
// turned back. Points that no tetrahedron uses go.
TetMesh read_tetrahedra(const std::filesystem::path& file);

}  // namespace pvg
