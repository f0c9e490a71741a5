// The dual mesh of a soft body: the surface that is seen, carried by the nodes that are simulated. Its points are
// W nodes, its normals the area-weighted means of its triangles'; both on the device.
#pragma once
#include <vector>

#include "host/device/device.hpp"
#include "host/geometry/loop_subdivision.hpp"  // SparseRows
#include "render/path.h"

namespace pvg {

class DualMesh {
 public:
  // normal_from: [n_vertices] the vertex whose triangles' mean is a vertex's normal, those of all that name it together
  DualMesh(Device& device, const SparseRows& W, const std::vector<Triangle>& triangles,
           const std::vector<std::uint32_t>& normal_from);
  // nodes: of the soft body [W.n_columns, m]. Writes point and normal of the vertices from first_vertex on; the texture
  // coordinates stay.
  void follow(const std::vector<Vec3>& nodes, Buffer<Vertex>& vertices, std::uint32_t first_vertex);
  std::size_t n_vertices() const { return n_vertices_; }

 private:
  std::size_t n_vertices_;
  Kernel points_kernel_, normals_kernel_;
  Buffer<std::uint32_t> row_start_, column_;
  Buffer<float> weight_;
  Buffer<std::uint32_t> triangles_;               // [n x 3]
  Buffer<std::uint32_t> corner_start_, corners_;  // triangles at each vertex, ascending
  std::vector<float> packed_;
  Buffer<float> nodes_;  // [W.n_columns x 3, m]
};

}  // namespace pvg
