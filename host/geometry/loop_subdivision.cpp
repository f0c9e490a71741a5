#include "host/geometry/loop_subdivision.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

using Row = std::vector<std::pair<std::uint32_t, double>>;  // column, weight; columns ascending

struct EdgeInfo {
  std::uint32_t number = 0;  // in the order in which the triangles first name them
  int n_triangles = 0;
  std::array<std::uint32_t, 2> opposite{};
  bool is_crease = false;
  bool is_sharp() const { return is_crease || n_triangles == 1; }
};
using Edges = std::map<Edge, EdgeInfo>;

Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

Edges collect_edges(std::span<const Triangle> triangles, std::span<const Edge> creases) {
  Edges edges;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const auto [at, is_new] = edges.try_emplace(edge_of(t[k], t[(k + 1) % 3]));
      EdgeInfo& edge = at->second;
      if (is_new) edge.number = std::uint32_t(edges.size() - 1);
      if (edge.n_triangles == 2)
        throw UsageError("subdivision: more than two triangles share the edge of points " +
                         std::to_string(at->first[0]) + " and " + std::to_string(at->first[1]) +
                         "; split the surface there");
      edge.opposite[edge.n_triangles++] = t[(k + 2) % 3];
    }
  for (const Edge& crease : creases) {
    const auto at = edges.find(edge_of(crease[0], crease[1]));
    if (at == edges.end())
      throw UsageError("subdivision: the crease of points " + std::to_string(crease[0]) + " and " +
                       std::to_string(crease[1]) + " is no edge of the surface");
    at->second.is_crease = true;
  }
  return edges;
}

// One level: what it makes of n_points points, as rows over them.
struct Level {
  std::vector<Row> rows;
  std::vector<Triangle> triangles;
  std::vector<Edge> creases;
};

Row point_row(std::uint32_t point, const std::vector<std::uint32_t>& neighbors,
              const std::vector<std::uint32_t>& sharp_neighbors) {
  if (sharp_neighbors.size() > 2) return {{point, 1}};
  if (sharp_neighbors.size() == 2)
    return {{point, 3.0 / 4}, {sharp_neighbors[0], 1.0 / 8}, {sharp_neighbors[1], 1.0 / 8}};
  const double n = double(neighbors.size()), c = 3.0 / 8 + std::cos(2 * std::numbers::pi / n) / 4;
  const double share = (5.0 / 8 - c * c) / n;
  Row row = {{point, 1 - n * share}};
  for (const std::uint32_t other : neighbors) row.push_back({other, share});
  return row;
}

Level refine(std::uint32_t n_points, std::span<const Triangle> triangles, std::span<const Edge> creases) {
  const Edges edges = collect_edges(triangles, creases);
  std::vector<std::vector<std::uint32_t>> neighbors(n_points), sharp_neighbors(n_points);
  Level level;
  level.rows.resize(n_points + edges.size());
  for (const auto& [ends, edge] : edges)
    for (int k = 0; k < 2; ++k) {
      neighbors[ends[k]].push_back(ends[1 - k]);
      if (edge.is_sharp()) sharp_neighbors[ends[k]].push_back(ends[1 - k]);
    }
  for (std::uint32_t i = 0; i < n_points; ++i) level.rows[i] = point_row(i, neighbors[i], sharp_neighbors[i]);
  for (const auto& [ends, edge] : edges) {
    const std::uint32_t middle = n_points + edge.number;
    Row& row = level.rows[middle];
    if (edge.is_sharp())
      row = {{ends[0], 0.5}, {ends[1], 0.5}};
    else
      row = {{ends[0], 3.0 / 8}, {ends[1], 3.0 / 8}, {edge.opposite[0], 1.0 / 8}, {edge.opposite[1], 1.0 / 8}};
    if (edge.is_crease) level.creases.insert(level.creases.end(), {Edge{ends[0], middle}, Edge{ends[1], middle}});
  }
  for (const auto& [a, b, c] : triangles) {
    const std::uint32_t ab = n_points + edges.at(edge_of(a, b)).number, bc = n_points + edges.at(edge_of(b, c)).number,
                        ca = n_points + edges.at(edge_of(c, a)).number;
    level.triangles.insert(level.triangles.end(),
                           {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}});
  }
  return level;
}

// the rows of a level, expressed in the coarse points
std::vector<Row> times(const std::vector<Row>& level, const std::vector<Row>& before) {
  std::vector<Row> product;
  for (const Row& row : level) {
    std::map<std::uint32_t, double> sum;
    for (const auto& [i, weight] : row)
      for (const auto& [column, inner] : before[i]) sum[column] += weight * inner;
    product.emplace_back(sum.begin(), sum.end());
  }
  return product;
}

}  // namespace

Subdivision subdivide_loop(std::size_t n_points, std::span<const Triangle> triangles, int levels,
                           std::span<const Edge> creases) {
  constexpr std::uint32_t UNUSED = 0xffffffff;
  std::vector<std::uint32_t> number(n_points, UNUSED);
  for (const Triangle& t : triangles)
    for (const std::uint32_t corner : t) {
      if (corner >= n_points)
        throw UsageError("subdivision: a triangle names point " + std::to_string(corner) + " of " +
                         std::to_string(n_points));
      number[corner] = 0;
    }
  // from here on only the points that are in use, in their order
  std::vector<Row> rows;
  for (std::uint32_t i = 0; i < n_points; ++i) {
    if (number[i] == UNUSED) continue;
    number[i] = std::uint32_t(rows.size());
    rows.push_back({{i, 1.0}});
  }
  Subdivision result;
  for (const auto& [a, b, c] : triangles) result.triangles.push_back({number[a], number[b], number[c]});
  for (const auto& [a, b] : creases) {
    if (a >= n_points || b >= n_points || number[a] == UNUSED || number[b] == UNUSED)
      throw UsageError("subdivision: a crease names a point that no triangle uses");
    result.creases.push_back({number[a], number[b]});
  }
  for (int k = 0; k < levels; ++k) {
    Level level = refine(std::uint32_t(rows.size()), result.triangles, result.creases);
    rows = times(level.rows, rows);
    result.triangles = std::move(level.triangles);
    result.creases = std::move(level.creases);
  }
  result.weights.n_columns = n_points;
  for (const Row& row : rows) {
    for (const auto& [column, weight] : row) {
      result.weights.column.push_back(column);
      result.weights.weight.push_back(weight);
    }
    result.weights.row_start.push_back(std::uint32_t(result.weights.column.size()));
  }
  return result;
}

std::vector<Vec3> multiply(const SparseRows& w, std::span<const Vec3> x) {
  if (x.size() != w.n_columns)
    throw UsageError("a matrix of " + counted(w.n_columns, "column") + " was given " + counted(x.size(), "point"));
  std::vector<Vec3> y(w.n_rows(), Vec3::Zero());
  for (std::size_t i = 0; i < y.size(); ++i)
    for (std::uint32_t k = w.row_start[i]; k < w.row_start[i + 1]; ++k) y[i] += w.weight[k] * x[w.column[k]];
  return y;
}

std::vector<Edge> sharp_edges(std::span<const Vec3> points, std::span<const Triangle> triangles, double angle) {
  const auto normal = [&](const Triangle& t) {
    return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).normalized().eval();
  };
  std::map<Edge, std::vector<Vec3>> normals;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) normals[edge_of(t[k], t[(k + 1) % 3])].push_back(normal(t));
  std::vector<Edge> sharp;
  for (const auto& [edge, sides] : normals)
    if (sides.size() == 2 && std::atan2(sides[0].cross(sides[1]).norm(), sides[0].dot(sides[1])) > angle)
      sharp.push_back(edge);
  return sharp;
}

}  // namespace pvg
