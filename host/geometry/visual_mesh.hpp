// A mesh for the eye: what the path tracer shows.
#pragma once
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

struct VisualMesh {
  std::vector<Vec3f> points;      // [n, m]
  std::vector<Vec3f> normals;     // [n] unit, or empty: flat shading
  std::vector<Vec2f> uvs;         // [n] or empty; v = 0 at the top row of the texture
  std::vector<Vec2f> second_uvs;  // [n] or empty; for textures that are laid out in another way
  std::vector<Vec3f> colors;      // [n] linear Rec. 709, multiply the material's colour; or empty
  std::vector<Triangle> triangles;
};

}  // namespace pvg
