// The assembled matrix against the sum of its elements' own dense blocks, carried to the nodes by hand.
#include "host/physics/linear/block_matrix.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "energies/body/inertia.h"
#include "energies/joint/zero_length_spring.h"

namespace pvg {
namespace {

// Five nodes: two free points, one fixed point, and a site carried by two nodes with weights 0.25 and 0.75.
TEST(BlockMatrix, IsTheSumOfItsElements) {
  Device device;
  const std::vector<Site> sites = {{{0, 0, 0, 0}, {1, 0, 0, 0}},
                                   {{1, 0, 0, 0}, {1, 0, 0, 0}},
                                   {{2, 0, 0, 0}, {1, 0, 0, 0}},
                                   {{3, 4, 0, 0}, {0.25, 0.75, 0, 0}}};
  const std::vector<u32> is_fixed = {0, 0, 1, 0, 0};
  Term mass(device, "body", "point_inertia", 1), spring(device, "joint", "zero_length_spring", 2),
      load(device, "body", "point_inertia", 1);
  mass.set(std::vector<PointInertia>{{{0}, 0, 2.0}, {{1}, 0, 3.0}}, {0, 2});
  spring.set(std::vector<ZeroLengthSpring>{{{0, 1}, 10.0}, {{1, 2}, 20.0}, {{0, 3}, 16.0}}, {0, 3});
  load.set(std::vector<PointInertia>{{{0}, 0, 5.0}}, {0, 1});
  const Buffer<f64> x(device, std::vector<double>(12, 0.0), "x");
  Term* const terms[] = {&mass, &spring, &load};
  BlockMatrix matrix(device, sites, is_fixed, terms);
  for (Term* term : terms) term->hessian(x, x, 1.0);
  matrix.assemble();
  matrix.assemble();  // from nothing each time

  // by hand, for each of the three directions; the fixed node has neither row nor column
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(5, 5);
  expected(0, 0) = 2 + 10 + 16 + 5;
  expected(1, 1) = 3 + 10 + 20;
  expected(0, 1) = expected(1, 0) = -10;
  expected(0, 3) = expected(3, 0) = -16 * 0.25;
  expected(0, 4) = expected(4, 0) = -16 * 0.75;
  expected(3, 3) = 16 * 0.0625;
  expected(3, 4) = expected(4, 3) = 16 * 0.1875;
  expected(4, 4) = 16 * 0.5625;
  EXPECT_EQ(matrix.pattern().find(1, 2), NO_BLOCK);
  EXPECT_EQ(matrix.pattern().find(2, 2), NO_BLOCK);

  Eigen::MatrixXd d(5, 3);
  for (int i = 0; i < 15; ++i) d(i / 3, i % 3) = std::sin(1.0 + 2.3 * i);
  std::vector<double> flat;
  for (int i = 0; i < 15; ++i) flat.push_back(d(i / 3, i % 3));
  Buffer<f64> direction(device, flat, "direction"), product(device, 15, "product");
  matrix.multiply(direction, product);
  const Eigen::MatrixXd by_hand = expected * d;
  const std::vector<double> found = product.read();
  for (int i = 0; i < 15; ++i) EXPECT_NEAR(found[i], by_hand(i / 3, i % 3), 1e-13) << i;

  // with rows of elements outside it, on the fixed node and on the site of two; and direction . product of each chunk
  const u32 row_sites[] = {2, 3};
  const RowBlock rows_of[] = {{row_sites, 0}};
  Gather gather(device, sites, 5);
  gather.set(rows_of);
  const Buffer<f64> rows(device, std::vector<double>{100, 100, 100, 4, 8, 12}, "rows");
  WorldChunks chunks(device, 2, GROUP_SIZE);
  const WorldRange ranges[] = {{0, 0, 2}, {1, 2, 5}};
  chunks.set(ranges);
  matrix.multiply_and_dot(direction, &gather, Buffer<u32>(device, is_fixed, "is_fixed"), rows, product, chunks);
  Eigen::MatrixXd with_rows = by_hand;
  with_rows.row(3) += 0.25 * Eigen::RowVector3d(4, 8, 12);
  with_rows.row(4) += 0.75 * Eigen::RowVector3d(4, 8, 12);
  const std::vector<double> found_with_rows = product.read(), sums = chunks.partial().read();
  for (int i = 0; i < 15; ++i) EXPECT_NEAR(found_with_rows[i], with_rows(i / 3, i % 3), 1e-13) << i;
  EXPECT_NEAR(sums[0], d.topRows(2).cwiseProduct(with_rows.topRows(2)).sum(), 1e-12);
  EXPECT_NEAR(sums[1], d.bottomRows(3).cwiseProduct(with_rows.bottomRows(3)).sum(), 1e-12);
}

}  // namespace
}  // namespace pvg
