#include "host/physics/linear/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <limits>

#include "spring_matrices.hpp"

namespace pvg {
namespace {

template <class Real>
Eigen::VectorXd solve(BlockCholesky<Real>& factor, Eigen::VectorXd x, Workers* workers = nullptr) {
  factor.solve(std::span(x.data(), std::size_t(x.size())), workers);
  return x;
}

TEST(BlockCholesky, SolvesAsEigenDoes) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Matrix matrix = masses_and_springs(c.n_nodes, c.edges, 1.0, 3.0, 5);
    BlockCholesky<double> factor(matrix.pattern);
    ASSERT_TRUE(factor.factorize(matrix.blocks));
    const Eigen::VectorXd x = solve(factor, right_hand_side(matrix));
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> reference(lower_triangle(matrix));
    const Eigen::VectorXd expected = reference.solve(right_hand_side(matrix));
    // condition numbers up to about 1e4
    EXPECT_LE((x - expected).norm(), 1e-11 * expected.norm());
  }
}

TEST(BlockCholesky, StaysBackwardStableForStiffSpringsBesideSmallMasses) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Matrix matrix = masses_and_springs(c.n_nodes, c.edges, 1e-3, 1e9, 6);
    BlockCholesky<double> factor(matrix.pattern);
    ASSERT_TRUE(factor.factorize(matrix.blocks));
    EXPECT_LE(backward_error(matrix, solve(factor, right_hand_side(matrix))), 1e-14);
  }
}

TEST(BlockCholesky, FactorsNewNumbersAsIfTheyWereTheFirst) {
  const Edges edges = solid(4, 5, 30);
  const Matrix first = masses_and_springs(600, edges, 1.0, 3.0, 7),
               second = masses_and_springs(600, edges, 2.0, 5.0, 8);
  BlockCholesky<double> factor(first.pattern), fresh(second.pattern);
  ASSERT_TRUE(factor.factorize(first.blocks));
  ASSERT_TRUE(factor.factorize(second.blocks));
  ASSERT_TRUE(fresh.factorize(second.blocks));
  EXPECT_EQ(solve(factor, right_hand_side(second)), solve(fresh, right_hand_side(second)));
}

TEST(BlockCholesky, GivesTheSameBitsForAnyNumberOfThreads) {
  // above the size at which threads are used, in solves too
  const Edges edges = solid(5, 12, 60);
  const Matrix matrix = masses_and_springs(3600, edges, 1.0, 3.0, 9);
  BlockCholesky<double> factor(matrix.pattern);
  ASSERT_TRUE(factor.uses_threads());
  ASSERT_TRUE(factor.factorize(matrix.blocks));
  const Eigen::VectorXd expected = solve(factor, right_hand_side(matrix));
  for (const std::size_t n_threads : {1, 2, 3, 8}) {
    Workers workers(n_threads);
    for (int repetition = 0; repetition < 3; ++repetition) {
      ASSERT_TRUE(factor.factorize(matrix.blocks, &workers));
      ASSERT_EQ(solve(factor, right_hand_side(matrix), &workers), expected) << n_threads << " threads";
    }
  }
}

TEST(BlockCholesky, RefusesWhatIsNotPositiveDefiniteAndRecovers) {
  Workers workers(2);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Matrix matrix = masses_and_springs(c.n_nodes, c.edges, 1.0, 3.0, 10);
    BlockCholesky<double> factor(matrix.pattern);
    for (const u32 node : {0u, c.n_nodes / 2, c.n_nodes - 1})
      for (const double spoiled :
           {-1e-3, 0.0, -1e9, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        Matrix broken = matrix;
        broken.blocks[9 * matrix.pattern.column_first[node] + 4] = spoiled;
        EXPECT_FALSE(factor.factorize(broken.blocks, &workers)) << "node " << node << ": " << spoiled;
      }
    ASSERT_TRUE(factor.factorize(matrix.blocks, &workers));
    EXPECT_LE(backward_error(matrix, solve(factor, right_hand_side(matrix))), 1e-14);
  }
}

TEST(BlockCholesky, RefusesNaNOffTheDiagonal) {
  Matrix matrix = masses_and_springs(57, chain(57), 1.0, 3.0, 11);
  BlockCholesky<double> factor(matrix.pattern);
  for (u32 block = 0; block < matrix.pattern.row.size(); ++block) {
    Matrix broken = matrix;
    broken.blocks[9 * block + 6] = std::numeric_limits<double>::quiet_NaN();  // third row, first column
    EXPECT_FALSE(factor.factorize(broken.blocks)) << "block " << block;
  }
}

// Condition numbers up to about 1e4, rounding 6e-8 and a few of them to each number.
TEST(BlockCholesky, SolvesInSinglePrecisionToItsRounding) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Matrix matrix = masses_and_springs(c.n_nodes, c.edges, 1.0, 3.0, 5);
    BlockCholesky<double> factor(matrix.pattern);
    BlockCholesky<float> single(matrix.pattern);
    ASSERT_TRUE(factor.factorize(matrix.blocks));
    ASSERT_TRUE(single.factorize(matrix.blocks));
    const Eigen::VectorXd expected = solve(factor, right_hand_side(matrix));
    EXPECT_LE((solve(single, right_hand_side(matrix)) - expected).norm(), 1e-3 * expected.norm());
  }
}

TEST(BlockCholesky, RefusesInSinglePrecisionWhatThatLoses) {
  // 57 masses against two springs: by hand the last pivot is about 57 / 1e7 and 57 / 1e5 of the diagonal
  for (const bool is_lost : {true, false}) {
    const Matrix matrix = masses_and_isotropic_springs(57, chain(57), 1.0, is_lost ? 1e7 : 1e5);
    BlockCholesky<float> single(matrix.pattern);
    EXPECT_EQ(single.factorize(matrix.blocks), !is_lost);
    BlockCholesky<double> factor(matrix.pattern);
    EXPECT_TRUE(factor.factorize(matrix.blocks));
  }
}

// A chain of heavy masses and soft springs, pulled at its end: by hand a node moves a millionth of its neighbour, the
// seventh by 1e-36 m and the eighth by 1e-42 m, which single precision has as a subnormal number only.
TEST(BlockCholesky, TakesSubnormalNumbersForZeroWhileItWorksAlone) {
  const volatile float tiny = 1e-30f, part = 1e-12f;
  const Matrix matrix = masses_and_isotropic_springs(57, chain(57), 1.0, 1e-6);
  BlockCholesky<float> single(matrix.pattern);
  ASSERT_TRUE(single.factorize(matrix.blocks));
  Eigen::VectorXd b = Eigen::VectorXd::Zero(3 * 57);
  b[0] = 1;
  const Eigen::VectorXd x = solve(single, b);
  EXPECT_NEAR(x[3 * 6], 1e-36, 1e-38);
#ifdef __x86_64__
  EXPECT_EQ(x[3 * 7], 0);
#endif
  EXPECT_GT(tiny * part, 0.0f);  // as before
}

TEST(BlockCholesky, TakesAnEmptyMatrix) {
  BlockCholesky<double> factor(BlockPattern{{0}, {}});
  EXPECT_TRUE(factor.factorize(std::span<const double>()));
  factor.solve({});
  EXPECT_EQ(factor.n_bytes(), 0u);
}

TEST(EliminationTree, KeepsALongThinSolidSparse) {
  // banded by hand: 100 layers of 27 nodes, each coupled to the next; a factor of the band alone has some
  // 2700 x 3 x (27 + 18) x 3 = 1.1e6 numbers and (27 x 1.5 x 3)^2 x 8100 = 1.2e8 operations
  const EliminationTree tree = eliminate(pattern_of(2700, solid(3, 9, 100)));
  EXPECT_LE(tree.cost, 2.4e8);
  for (u32 i = 0; i < 2700; ++i) ASSERT_EQ(tree.position[tree.order[i]], i);
}

std::vector<Vec3> lattice(u32 w, u32 h, u32 d) {
  std::vector<Vec3> position;
  for (u32 z = 0; z < d; ++z)
    for (u32 y = 0; y < h; ++y)
      for (u32 x = 0; x < w; ++x) position.emplace_back(x, y, z);
  return position;
}

TEST(EliminationTree, CutsACubeWhereItIsThinnest) {
  // by hand: the first cut is a layer of 15 x 15 nodes, its dense Cholesky 3 (15^2) unknowns deep; by George's sum the
  // whole takes some ten times that. Without positions nothing knows where a layer is.
  const BlockPattern cube = pattern_of(15 * 15 * 15, solid(15, 15, 15));
  const double top = std::pow(3 * 15 * 15, 3) / 3;
  const EliminationTree tree = eliminate(cube, lattice(15, 15, 15));
  EXPECT_LE(tree.cost, 20 * top);
  EXPECT_LE(tree.cost, 0.75 * eliminate(cube).cost);
  EXPECT_EQ(std::set<u32>(tree.order.begin(), tree.order.end()).size(), cube.n_nodes());
}

TEST(EliminationTree, DissectsWhatLiesInOnePlaceOrInPieces) {
  const u32 n = 400;
  Edges edges = solid(5, 5, 8);
  for (const auto& [a, b] : solid(5, 5, 8)) edges.emplace_back(a + 200, b + 200);  // a second piece
  const BlockPattern pattern = pattern_of(n, edges);
  std::vector<Vec3> two = lattice(5, 5, 8);
  two.insert(two.end(), two.begin(), two.end());  // in the same place as the first
  for (const std::vector<Vec3>& position : {two, std::vector<Vec3>(n, Vec3::Zero())}) {
    const EliminationTree tree = eliminate(pattern, position);
    EXPECT_EQ(std::set<u32>(tree.order.begin(), tree.order.end()).size(), n);
    EXPECT_LE(tree.cost, eliminate(pattern).cost);
  }
}

TEST(BlockCholesky, SolvesInTheOrderOfDissection) {
  const Matrix matrix = masses_and_springs(1000, solid(10, 10, 10), 1, 100, 3);
  BlockCholesky<double> with(matrix.pattern, lattice(10, 10, 10)), without(matrix.pattern);
  EXPECT_LT(with.tree().cost, without.tree().cost);  // so that it is taken here
  ASSERT_TRUE(with.factorize(matrix.blocks));
  ASSERT_TRUE(without.factorize(matrix.blocks));
  const Eigen::VectorXd b = right_hand_side(matrix), x = solve(with, b);
  EXPECT_LT((x - solve(without, b)).norm(), 1e-10 * x.norm());
}

TEST(Workers, RunEveryTaskOnce) {
  for (const std::size_t n_threads : {1, 2, 5}) {
    Workers workers(n_threads);
    for (const std::size_t n_tasks : {0, 1, 3, 257}) {
      std::vector<int> n_runs(n_tasks, 0);
      workers.run(n_tasks, [&](std::size_t i) { ++n_runs[i]; });
      EXPECT_EQ(n_runs, std::vector<int>(n_tasks, 1));
    }
  }
}

}  // namespace
}  // namespace pvg
