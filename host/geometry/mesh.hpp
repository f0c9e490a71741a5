// Plain meshes. Lengths in metres.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pvg {

using Vec3 = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;
using Vec2f = Eigen::Vector2f;
using Triangle = std::array<std::uint32_t, 3>;
using Edge = std::array<std::uint32_t, 2>;

// A surface. Triangles are counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> points;         // [n_points, m]
  std::vector<Triangle> triangles;  // indices into points
};

// A solid of tetrahedra with 4 nodes (linear) or 10 nodes (quadratic).
// Node order of a 10-node element: corners 0 1 2 3, then the midpoints of edges 01 12 02 03 13 23.
// Corners are ordered so that det [x1-x0, x2-x0, x3-x0] > 0.
struct TetMesh {
  std::vector<Vec3> points;             // [n_points, m], rest shape
  int nodes_per_element = 10;           // 4 or 10
  std::vector<std::uint32_t> elements;  // [n_elements x nodes_per_element]
  std::vector<Triangle> surface;        // boundary; for 10-node elements split into 4 linear triangles per face
  std::size_t n_elements() const { return elements.size() / nodes_per_element; }
};

}  // namespace pvg
