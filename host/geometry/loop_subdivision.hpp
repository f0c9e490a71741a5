// Loop subdivision of a triangle mesh as one sparse matrix: fine = W coarse, W = S(levels) ... S(1).
// Loop 1987, "Smooth Subdivision Surfaces Based on Triangles"; creases and boundaries: Hoppe et al. 1994. Every row of
// W is a convex combination: the fine surface lies within the hull of the coarse points, and moves rigidly with them.
#pragma once
#include <span>

#include "host/geometry/mesh.hpp"

namespace pvg {

// A sparse matrix by rows: entries row_start[i] .. row_start[i + 1] - 1 are row i, columns ascending.
struct SparseRows {
  std::size_t n_columns = 0;
  std::vector<std::uint32_t> row_start = {0};  // [n_rows + 1]
  std::vector<std::uint32_t> column;           // [n_entries]
  std::vector<double> weight;                  // [n_entries]
  std::size_t n_rows() const { return row_start.size() - 1; }
};

struct Subdivision {
  SparseRows weights;               // W [n_fine x n_points]
  std::vector<Triangle> triangles;  // of fine points, 4^levels for each coarse one
  std::vector<Edge> creases;        // of fine points
};

// `triangles` name some of n_points points; fine points exist only for those, the named points first. Boundary edges,
// and those in `creases`, stay sharp curves; a point where more than two of them meet stays where it is.
// Throws a UsageError where three triangles share an edge, or an index is out of range.
Subdivision subdivide_loop(std::size_t n_points, std::span<const Triangle> triangles, int levels,
                           std::span<const Edge> creases = {});

// W x; x: [W.n_columns]
std::vector<Vec3> multiply(const SparseRows& w, std::span<const Vec3> x);

// Edges where the normals of the two triangles differ by more than `angle` [rad], to be kept sharp.
std::vector<Edge> sharp_edges(std::span<const Vec3> points, std::span<const Triangle> triangles, double angle);

}  // namespace pvg
