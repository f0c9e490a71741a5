// In which precision the host factors a group.
#include "host/physics/linear/group_preconditioner.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "spring_matrices.hpp"

namespace pvg {
namespace {

// z = M^-1 b of one group of these masses and springs.
Eigen::VectorXd precondition(const Matrix& matrix, const Eigen::VectorXd& b) {
  const u32 n = matrix.pattern.n_nodes();
  std::vector<std::vector<std::pair<u32, u32>>> rows(n);  // column, block: both halves
  for (u32 c = 0; c < n; ++c)
    for (u32 k = matrix.pattern.column_first[c]; k < matrix.pattern.column_first[c + 1]; ++k) {
      rows[matrix.pattern.row[k]].emplace_back(c, k);
      if (matrix.pattern.row[k] != c) rows[c].emplace_back(matrix.pattern.row[k], k);
    }
  MatrixPattern pattern{{0}, {}};
  std::vector<double> blocks;
  for (u32 r = 0; r < n; ++r) {
    std::sort(rows[r].begin(), rows[r].end());
    for (const auto& [c, k] : rows[r]) {
      pattern.column.push_back(c);
      for (u32 e = 0; e < 9; ++e) blocks.push_back(matrix.blocks[9 * k + (r >= c ? e : 3 * (e % 3) + e / 3)]);
    }
    pattern.first.push_back(u32(pattern.column.size()));
  }
  std::vector<Site> sites;
  for (u32 i = 0; i < n; ++i) sites.push_back({{i, 0, 0, 0}, {1, 0, 0, 0}});
  GroupPreconditioner preconditioner(pattern, sites, std::vector<double>(3 * n, 0.0), std::vector<u32>(n, 0),
                                     std::vector<u32>{0});
  Device device;
  const Buffer<f64> values(device, blocks, "matrix blocks");
  EXPECT_EQ(preconditioner.factorize(values, {}, std::vector<char>{true}), std::nullopt);
  Eigen::VectorXd z(3 * n);
  preconditioner.apply({b.data(), std::size_t(b.size())}, {z.data(), std::size_t(z.size())});
  return z;
}

double error_of(const Matrix& matrix) {
  const Eigen::VectorXd b = right_hand_side(matrix);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> reference(lower_triangle(matrix));
  const Eigen::VectorXd expected = reference.solve(b);
  return (precondition(matrix, b) - expected).norm() / expected.norm();
}

TEST(GroupPreconditioner, FactorsLargeGroupsInSinglePrecisionSmallOnesInDouble) {
  const double small = error_of(masses_and_springs(60, solid(3, 4, 5), 1.0, 3.0, 5));
  EXPECT_LE(small, 1e-11);
  const double large = error_of(masses_and_springs(1000, solid(10, 10, 10), 1.0, 3.0, 5));
  EXPECT_LE(large, 1e-3);
  EXPECT_GE(large, 1e-10);  // the rounding of single precision: this one did not take twice the time
}

TEST(GroupPreconditioner, FactorsInDoubleWhatSinglePrecisionLoses) {
  const Matrix matrix = masses_and_isotropic_springs(1000, solid(10, 10, 10), 1e-3, 1e9);
  EXPECT_LE(backward_error(matrix, precondition(matrix, right_hand_side(matrix))), 1e-14);
}

}  // namespace
}  // namespace pvg
