// Points carried by tetrahedra: properties of W, on a bar of 4-node and of 10-node elements.
#include "host/geometry/tet_embedding.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "host/geometry/primitive_shapes.hpp"
#include "host/geometry/tet_mesh.hpp"

namespace pvg {
namespace {

struct EmbeddingCase {
  TetMesh mesh;
  std::vector<Vec3> points;  // inside, on the surface, and up to 1 cm outside
};

// 10 x 4 x 2 cm about the origin
std::vector<EmbeddingCase> cases() {
  const TetMesh linear = box_solid({0.1, 0.04, 0.02}, {5, 2, 1}, 4);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> points(1000);
  for (Vec3& p : points) p = Vec3(0.06 * uniform(random), 0.03 * uniform(random), 0.02 * uniform(random));
  points.emplace_back(0, 0, 0);
  points.push_back(linear.points.front());
  return {{linear, points}, {make_quadratic(linear), points}};
}

TEST(TetEmbedding, RowsSumToOneAndNameFourNodes) {
  for (const EmbeddingCase& c : cases()) {
    const Embedding embedding = embed_points(c.mesh, c.points);
    const SparseRows& W = embedding.weights;
    ASSERT_EQ(W.n_rows(), c.points.size());
    ASSERT_EQ(W.n_columns, c.mesh.points.size());
    for (std::size_t i = 0; i < W.n_rows(); ++i) {
      ASSERT_EQ(W.row_start[i + 1] - W.row_start[i], 4u);
      double sum = 0, least = 1;
      for (std::uint32_t k = W.row_start[i]; k < W.row_start[i + 1]; ++k) {
        sum += W.weight[k];
        least = std::min(least, W.weight[k]);
        ASSERT_TRUE(k == W.row_start[i] || W.column[k - 1] < W.column[k]);
      }
      EXPECT_NEAR(sum, 1, 1e-12);
      EXPECT_TRUE(embedding.distance[i] > 0 || least >= 0) << i;
    }
  }
}

TEST(TetEmbedding, DistanceIsThatFromTheBox) {
  for (const EmbeddingCase& c : cases()) {
    const Embedding embedding = embed_points(c.mesh, c.points);
    std::size_t n_outside = 0;
    for (std::size_t i = 0; i < c.points.size(); ++i) {
      const double expected = (c.points[i].cwiseAbs() - Vec3(0.05, 0.02, 0.01)).cwiseMax(0).norm();
      EXPECT_NEAR(embedding.distance[i], expected, 1e-9);
      n_outside += expected > 0;
    }
    EXPECT_GT(n_outside, 300u);
    EXPECT_LT(n_outside, 900u);
  }
}

TEST(TetEmbedding, ALinearFieldIsReproduced) {
  Eigen::Matrix3d A;
  A << 1.2, 0.3, -0.4, 0.1, 0.7, 0.2, -0.5, 0.6, 1.1;
  const auto field = [&](const Vec3& x) { return Vec3(A * x + Vec3(3, -2, 1)); };
  for (const EmbeddingCase& c : cases()) {
    std::vector<Vec3> nodes;
    for (const Vec3& x : c.mesh.points) nodes.push_back(field(x));
    const std::vector<Vec3> carried = multiply(embed_points(c.mesh, c.points).weights, nodes);
    for (std::size_t i = 0; i < carried.size(); ++i) EXPECT_LT((carried[i] - field(c.points[i])).norm(), 1e-12);
  }
}

TEST(TetEmbedding, ARigidMotionIsTheSameRigidMotion) {
  const Eigen::Isometry3d motion =
      Eigen::Translation3d(0.5, -1, 2) * Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized());
  for (const EmbeddingCase& c : cases()) {
    std::vector<Vec3> nodes;
    for (const Vec3& x : c.mesh.points) nodes.push_back(motion * x);
    const std::vector<Vec3> carried = multiply(embed_points(c.mesh, c.points).weights, nodes);
    for (std::size_t i = 0; i < carried.size(); ++i) EXPECT_LT((carried[i] - motion * c.points[i]).norm(), 1e-12);
  }
}

// Where the midpoints of 10-node elements are pulled aside, a point on a face of the surface follows it.
TEST(TetEmbedding, PointsOfTheSurfaceStayOnIt) {
  const TetMesh mesh = make_quadratic(box_solid({0.1, 0.04, 0.02}, {5, 2, 1}, 4));
  std::vector<Vec3> points, nodes = mesh.points;
  for (const auto& [a, b, d] : mesh.surface) points.push_back((mesh.points[a] + mesh.points[b] + mesh.points[d]) / 3);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1e-3, 1e-3);
  for (Vec3& x : nodes) x += Vec3(uniform(random), uniform(random), uniform(random));
  const std::vector<Vec3> carried = multiply(embed_points(mesh, points).weights, nodes);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [a, b, d] = mesh.surface[i];
    EXPECT_LT((carried[i] - (nodes[a] + nodes[b] + nodes[d]) / 3).norm(), 1e-12) << i;
  }
}

}  // namespace
}  // namespace pvg
