// Meshes from files: OBJ, STL, PLY and DAE by assimp, glTF and GLB by tinygltf. All parts of a file are joined, the
// transforms of its nodes applied. Units are taken as metres. UsageErrors name the file and what to do.
#pragma once
#include <filesystem>
#include <string>

#include "host/geometry/mesh.hpp"
#include "host/geometry/visual_mesh.hpp"

namespace pvg {

// For simulation: points welded (those within 1e-7 of the mesh's size are one); not checked further.
TriangleMesh read_surface(const std::filesystem::path& file);

// The same, and it must enclose a solid (geometry/mesh_checks.hpp).
TriangleMesh read_closed_surface(const std::filesystem::path& file);

// For rendering: points, triangles, texture coordinates if the file has them (v = 0 at the top row of the picture) and
// smooth normals: the file's if it has them, else across edges flatter than crease_angle [rad]. crease_angle 0: none.
VisualMesh read_visual_mesh(const std::filesystem::path& file, double crease_angle = 0.7);

// As it lies in the file, flat shaded, with the colours of its points, which OBJ and PLY files may have in sRGB.
VisualMesh read_colored_mesh(const std::filesystem::path& file);

// A surface as it is, flat shaded.
VisualMesh visual_of(const TriangleMesh& surface);

// As an OBJ file, to nine digits.
std::string obj_text(const TriangleMesh& mesh);

// Notes on stderr that a body of this size may be in millimetres.
void tell_of_size(const TriangleMesh& mesh, const std::string& file);

}  // namespace pvg
