// What the readers of mesh files hand over before it becomes a surface or a visual mesh: one vertex per corner or per
// point, as the file has it.
#pragma once
#include <filesystem>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

struct RawMesh {
  std::vector<Vec3> points;   // [n, m], node transforms applied
  std::vector<Vec3> normals;  // [n] or empty if any part has none
  std::vector<Vec2f> uvs;     // [n] or empty if any part has none; v = 0 at the top row
  std::vector<Vec3f> colors;  // [n] linear Rec. 709, or empty if any part has none; not read of glTF
  std::vector<Triangle> triangles;
};

RawMesh read_with_assimp(const std::filesystem::path& file);
RawMesh read_gltf(const std::filesystem::path& file);  // y up in the file becomes z up

}  // namespace pvg
