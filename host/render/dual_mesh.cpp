#include "host/render/dual_mesh.hpp"

#include <stdexcept>

namespace pvg {
namespace {

std::vector<float> to_float(const std::vector<double>& values) { return {values.begin(), values.end()}; }

std::vector<std::uint32_t> flat(const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> indices;
  for (const Triangle& t : triangles) indices.insert(indices.end(), t.begin(), t.end());
  return indices;
}

// The triangles at each vertex, ascending; those of vertices that share a normal together.
struct Corners {
  std::vector<std::uint32_t> start = {0};  // [n_vertices + 1]
  std::vector<std::uint32_t> triangles;
};

Corners corners_of(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& normal_from) {
  std::vector<std::vector<std::uint32_t>> at(normal_from.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t corner : triangles[t]) at[normal_from[corner]].push_back(t);
  Corners corners;
  for (const std::uint32_t first : normal_from) {
    corners.triangles.insert(corners.triangles.end(), at[first].begin(), at[first].end());
    corners.start.push_back(std::uint32_t(corners.triangles.size()));
  }
  return corners;
}

}  // namespace

DualMesh::DualMesh(Device& device, const SparseRows& W, const std::vector<Triangle>& triangles,
                   const std::vector<std::uint32_t>& normal_from)
    : n_vertices_(W.n_rows()),
      points_kernel_(Program(device, "render/dual_mesh.cl").kernel("dual_mesh_points")),
      normals_kernel_(Program(device, "render/dual_mesh.cl").kernel("dual_mesh_normals")),
      row_start_(device, W.row_start, "row_start"),
      column_(device, W.column, "column"),
      weight_(device, to_float(W.weight), "weight"),
      triangles_(device, flat(triangles), "triangles"),
      corner_start_(device, 0, "corner_start"),
      corners_(device, 0, "corners"),
      packed_(3 * W.n_columns),
      nodes_(device, packed_, "nodes") {
  const Corners corners = corners_of(triangles, normal_from);
  corner_start_ = Buffer<std::uint32_t>(device, corners.start, "corner_start");
  corners_ = Buffer<std::uint32_t>(device, corners.triangles, "corners");
}

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
