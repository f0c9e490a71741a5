#include "host/render/dual_mesh.hpp"

#include <numeric>

namespace pvg {
namespace {

std::vector<float> to_float(const std::vector<double>& values) { return {values.begin(), values.end()}; }

std::vector<std::uint32_t> flat(const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> indices;
  for (const Triangle& t : triangles) indices.insert(indices.end(), t.begin(), t.end());
  return indices;
}

// where the triangles at each vertex begin, then the end
std::vector<std::uint32_t> corner_starts(std::size_t n_vertices, const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> starts(n_vertices + 1, 0);
  for (const Triangle& t : triangles)
    for (const std::uint32_t corner : t) ++starts[corner + 1];
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  return starts;
}

std::vector<std::uint32_t> triangles_at_corners(std::size_t n_vertices, const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> next = corner_starts(n_vertices, triangles), at(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t corner : triangles[t]) at[next[corner]++] = t;
  return at;
}

}  // namespace

DualMesh::DualMesh(Device& device, const Subdivision& subdivision)
    : n_vertices_(subdivision.weights.n_rows()),
      points_kernel_(Program(device, "render/dual_mesh.cl").kernel("dual_mesh_points")),
      normals_kernel_(Program(device, "render/dual_mesh.cl").kernel("dual_mesh_normals")),
      row_start_(device, subdivision.weights.row_start, "row_start"),
      column_(device, subdivision.weights.column, "column"),
      weight_(device, to_float(subdivision.weights.weight), "weight"),
      triangles_(device, flat(subdivision.triangles), "triangles"),
      corner_start_(device, corner_starts(n_vertices_, subdivision.triangles), "corner_start"),
      corners_(device, triangles_at_corners(n_vertices_, subdivision.triangles), "corners"),
      packed_(3 * subdivision.weights.n_columns),
      nodes_(device, packed_, "nodes") {}

void DualMesh::follow(const std::vector<Vec3>& nodes, Buffer<Vertex>& vertices, std::uint32_t first_vertex) {
  if (3 * nodes.size() != packed_.size() || first_vertex + n_vertices_ > vertices.size())
    throw std::logic_error("dual mesh: " + std::to_string(packed_.size() / 3) + " nodes and room for " +
                           std::to_string(n_vertices_) + " vertices are needed");
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int c = 0; c < 3; ++c) packed_[3 * i + c] = float(nodes[i](c));
  nodes_.write(packed_);
  const std::uint32_t n = std::uint32_t(n_vertices_);
  points_kernel_(n, n, row_start_, column_, weight_, nodes_, first_vertex, vertices);
  normals_kernel_(n, n, corner_start_, corners_, triangles_, first_vertex, vertices);
}

}  // namespace pvg
