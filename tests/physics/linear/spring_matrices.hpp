// Matrices of masses and springs for the tests of factors.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <cmath>
#include <random>
#include <set>

#include "host/physics/linear/elimination_tree.hpp"

namespace pvg {

using Edges = std::vector<std::pair<u32, u32>>;

struct Matrix {
  BlockPattern pattern;
  std::vector<double> blocks;
};

inline BlockPattern pattern_of(u32 n_nodes, const Edges& edges) {
  std::vector<std::set<u32>> columns(n_nodes);
  for (u32 i = 0; i < n_nodes; ++i) columns[i].insert(i);
  for (const auto& [a, b] : edges) columns[std::min(a, b)].insert(std::max(a, b));
  BlockPattern pattern{{0}, {}};
  for (const std::set<u32>& column : columns) {
    pattern.row.insert(pattern.row.end(), column.begin(), column.end());
    pattern.column_first.push_back(u32(pattern.row.size()));
  }
  return pattern;
}

// One mass at each node, one random positive semidefinite 6 x 6 block for each coupling: definite by construction, as
// the hessian of masses and springs is.
inline Matrix masses_and_springs(u32 n_nodes, const Edges& edges, double mass, double stiffness, u32 seed) {
  Matrix matrix{pattern_of(n_nodes, edges), {}};
  matrix.blocks.assign(9 * matrix.pattern.row.size(), 0.0);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto block = [&](u32 row, u32 column) {
    u32 k = matrix.pattern.column_first[column];
    while (matrix.pattern.row[k] != row) ++k;
    return &matrix.blocks[9 * k];
  };
  for (u32 i = 0; i < n_nodes; ++i)
    for (int c = 0; c < 3; ++c) block(i, i)[4 * c] += mass * (1 + 0.5 * std::sin(i + c));
  for (const auto& [a, b] : edges) {
    if (a == b) continue;
    Eigen::Matrix<double, 3, 6> root;
    for (double& number : root.reshaped()) number = normal(random);
    const Eigen::Matrix<double, 6, 6> spring = stiffness * root.transpose() * root;
    const u32 ends[2] = {std::min(a, b), std::max(a, b)};
    for (const auto& [row, column] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1)})
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) block(ends[row], ends[column])[3 * r + c] += spring(3 * row + r, 3 * column + c);
  }
  return matrix;
}

// The same with springs that pull alike in all directions: as a whole it moves against the masses alone, so that all
// but mass / stiffness of what stands on the diagonal cancels in its last pivot.
inline Matrix masses_and_isotropic_springs(u32 n_nodes, const Edges& edges, double mass, double stiffness) {
  Matrix matrix{pattern_of(n_nodes, edges), {}};
  matrix.blocks.assign(9 * matrix.pattern.row.size(), 0.0);
  for (u32 column = 0; column < n_nodes; ++column)
    for (u32 k = matrix.pattern.column_first[column]; k < matrix.pattern.column_first[column + 1]; ++k) {
      const u32 row = matrix.pattern.row[k];
      for (int c = 0; c < 3; ++c) {
        matrix.blocks[9 * k + 4 * c] += row == column ? mass : -stiffness;
        if (row == column) continue;
        for (const u32 end : {row, column}) matrix.blocks[9 * matrix.pattern.column_first[end] + 4 * c] += stiffness;
      }
    }
  return matrix;
}

inline Eigen::SparseMatrix<double> lower_triangle(const Matrix& matrix) {
  std::vector<Eigen::Triplet<double>> entries;
  for (u32 column = 0; column < matrix.pattern.n_nodes(); ++column)
    for (u32 k = matrix.pattern.column_first[column]; k < matrix.pattern.column_first[column + 1]; ++k)
      for (u32 r = 0; r < 3; ++r)
        for (u32 c = 0; c < 3; ++c)
          if (matrix.pattern.row[k] != column || r >= c)
            entries.emplace_back(3 * matrix.pattern.row[k] + r, 3 * column + c, matrix.blocks[9 * k + 3 * r + c]);
  Eigen::SparseMatrix<double> lower(3 * matrix.pattern.n_nodes(), 3 * matrix.pattern.n_nodes());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

inline Eigen::VectorXd right_hand_side(const Matrix& matrix) {
  Eigen::VectorXd b(3 * matrix.pattern.n_nodes());
  for (int i = 0; i < b.size(); ++i) b[i] = std::sin(1 + 7.3 * i);
  return b;
}

// |A x - b| against what rounding of x alone may leave
inline double backward_error(const Matrix& matrix, const Eigen::VectorXd& x) {
  const Eigen::SparseMatrix<double> lower = lower_triangle(matrix);
  const Eigen::VectorXd b = right_hand_side(matrix);
  const Eigen::VectorXd residual = lower.selfadjointView<Eigen::Lower>() * x - b;
  const Eigen::SparseMatrix<double> sizes = lower.cwiseAbs();
  const double largest = (sizes.selfadjointView<Eigen::Lower>() * Eigen::VectorXd::Ones(x.size())).eval().maxCoeff();
  return residual.lpNorm<Eigen::Infinity>() / (largest * x.lpNorm<Eigen::Infinity>() + b.lpNorm<Eigen::Infinity>());
}

inline Edges random_edges(u32 n_nodes, u32 n_edges, u32 reach, u32 seed) {
  std::mt19937 random(seed);
  Edges edges;
  for (u32 i = 0; i < n_edges; ++i) {
    const u32 a = random() % n_nodes, b = a + random() % reach;
    if (b < n_nodes) edges.emplace_back(a, b);
  }
  return edges;
}

inline Edges complete(u32 n_nodes) {
  Edges edges;
  for (u32 a = 0; a < n_nodes; ++a)
    for (u32 b = 0; b < a; ++b) edges.emplace_back(a, b);
  return edges;
}

inline Edges chain(u32 n_nodes) {
  Edges edges;
  for (u32 a = 1; a < n_nodes; ++a) edges.emplace_back(a - 1, a);
  return edges;
}

// w x h x d nodes, each coupled to all within one step, as elements of a solid couple them
inline Edges solid(u32 w, u32 h, u32 d) {
  Edges edges;
  const auto node = [=](u32 x, u32 y, u32 z) { return x + w * (y + h * z); };
  for (u32 z = 0; z < d; ++z)
    for (u32 y = 0; y < h; ++y)
      for (u32 x = 0; x < w; ++x)
        for (u32 k = 0; k < 27; ++k) {
          const u32 x2 = x + k % 3, y2 = y + k / 3 % 3, z2 = z + k / 9;  // one more than the neighbour's
          if (x2 < 1 || y2 < 1 || z2 < 1 || x2 > w || y2 > h || z2 > d) continue;
          edges.emplace_back(node(x, y, z), node(x2 - 1, y2 - 1, z2 - 1));
        }
  return edges;
}

struct Case {
  const char* name;
  u32 n_nodes;
  Edges edges;
};

inline std::vector<Case> cases() {
  return {{"one node", 1, {}},
          {"two nodes", 2, {{0, 1}}},
          {"three nodes, two coupled", 3, {{0, 2}}},
          {"57 nodes without couplings", 57, {}},
          {"57 nodes, disconnected parts", 57, random_edges(57, 40, 57, 1)},
          {"57 nodes", 57, random_edges(57, 300, 57, 2)},
          {"400 nodes", 400, random_edges(400, 900, 400, 3)},
          {"400 nodes, long and thin", 400, random_edges(400, 3000, 15, 4)},
          {"chain", 257, chain(257)},
          {"dense", 61, complete(61)},
          {"solid", 600, solid(4, 5, 30)}};
}

}  // namespace pvg
