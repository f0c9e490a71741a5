// Loop subdivision as a sparse matrix.
#include "host/geometry/loop_subdivision.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>

#include "host/base/error.hpp"

namespace pvg {
namespace {

TriangleMesh icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return mesh;
}

// n x n squares of 1 m, each of two triangles
TriangleMesh sheet(int n) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.points.push_back(Vec3(i, j, 0));
  const auto at = [n](int i, int j) { return std::uint32_t(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

TEST(LoopSubdivision, CountsAreThoseOfEuler) {
  const TriangleMesh mesh = icosahedron();
  for (int levels = 0; levels <= 3; ++levels) {
    const Subdivision fine = subdivide_loop(12, mesh.triangles, levels);
    EXPECT_EQ(fine.triangles.size(), 20u << (2 * levels));
    EXPECT_EQ(fine.weights.n_rows(), 2 + fine.triangles.size() / 2);
  }
}

TEST(LoopSubdivision, RowsAreConvexCombinations) {
  for (const TriangleMesh& mesh : {icosahedron(), sheet(4)}) {
    const SparseRows w = subdivide_loop(mesh.points.size(), mesh.triangles, 3).weights;
    for (std::size_t i = 0; i < w.n_rows(); ++i) {
      double sum = 0;
      for (std::uint32_t k = w.row_start[i]; k < w.row_start[i + 1]; ++k) {
        EXPECT_GE(w.weight[k], 0);
        EXPECT_TRUE(k == w.row_start[i] || w.column[k - 1] < w.column[k]);
        sum += w.weight[k];
      }
      EXPECT_NEAR(sum, 1, 1e-14);
    }
  }
}

TEST(LoopSubdivision, MovesRigidlyWithTheCoarsePoints) {
  const TriangleMesh mesh = icosahedron();
  const Subdivision fine = subdivide_loop(12, mesh.triangles, 2);
  Eigen::Isometry3d motion(Eigen::AngleAxisd(1.3, Vec3(1, 2, 3).normalized()));
  motion.pretranslate(Vec3(0.4, -2, 5));
  std::vector<Vec3> moved = mesh.points;
  for (Vec3& x : moved) x = motion * x;
  const std::vector<Vec3> before = multiply(fine.weights, mesh.points), after = multiply(fine.weights, moved);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LE((after[i] - motion * before[i]).norm(), 1e-13);
}

// A vertex of valence 5 tends to 1/(1 + 3/(8 b)) of itself and the rest of its neighbours' mean, b = the share of the
// neighbours in one step; the limit lies on the axis, so the ratio of radii follows by hand.
TEST(LoopSubdivision, IcosahedronsCornersTendToTheLimitPoint) {
  const TriangleMesh mesh = icosahedron();
  const std::vector<Vec3> fine = multiply(subdivide_loop(12, mesh.triangles, 6).weights, mesh.points);
  const double c = 3.0 / 8 + std::cos(2 * M_PI / 5) / 4, share = 5.0 / 8 - c * c;
  const double own = 1 / (1 + 8 * share / 3);
  // the neighbours' mean is 1/sqrt 5 of the corner itself
  const double ratio = own + (1 - own) / std::sqrt(5.0);
  for (int i = 0; i < 12; ++i) EXPECT_LE((fine[i] - ratio * mesh.points[i]).norm(), 1e-4);
}

// in the regular interior of a sheet Loop's surface is a box spline: it reproduces planes, and heights of x^2 up to a
// constant
TEST(LoopSubdivision, AFlatSheetStaysFlatAndKeepsItsBoundary) {
  const TriangleMesh mesh = sheet(4);
  const Subdivision fine = subdivide_loop(mesh.points.size(), mesh.triangles, 2);
  double left = 1, right = 3;
  for (const Vec3& x : multiply(fine.weights, mesh.points)) {
    EXPECT_EQ(x(2), 0);
    left = std::min(left, x(0));
    right = std::max(right, x(0));
  }
  EXPECT_NEAR(left, 0, 1e-14);
  EXPECT_NEAR(right, 4, 1e-14);
}

TEST(LoopSubdivision, TrianglesKeepTheirOrientation) {
  const TriangleMesh mesh = icosahedron();
  const Subdivision fine = subdivide_loop(12, mesh.triangles, 2);
  const std::vector<Vec3> x = multiply(fine.weights, mesh.points);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (const auto& [a, b, c] : fine.triangles) {
    EXPECT_GT((x[b] - x[a]).cross(x[c] - x[a]).dot(x[a] + x[b] + x[c]), 0);
    ++directed[{a, b}], ++directed[{b, c}], ++directed[{c, a}];
  }
  for (const auto& [edge, n] : directed) {
    EXPECT_EQ(n, 1);
    EXPECT_EQ(directed.count({edge.second, edge.first}), 1u) << "a hole";
  }
}

// a cube whose edges are creases stays a cube; without creases it rounds off
TEST(LoopSubdivision, CreasesKeepACubesEdges) {
  TriangleMesh cube;
  for (int i = 0; i < 8; ++i) cube.points.push_back(Vec3(i & 1, (i >> 1) & 1, i >> 2));
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const std::vector<Edge> creases = sharp_edges(cube.points, cube.triangles, 0.5);
  EXPECT_EQ(creases.size(), 12u);
  const auto largest_distance_from_surface = [&](std::span<const Edge> kept) {
    double distance = 0;
    for (const Vec3& x : multiply(subdivide_loop(8, cube.triangles, 2, kept).weights, cube.points)) {
      const Vec3 depth = (Vec3::Constant(0.5) - (x - Vec3::Constant(0.5)).cwiseAbs());
      distance = std::max(distance, depth.minCoeff());
    }
    return distance;
  };
  EXPECT_LE(largest_distance_from_surface(creases), 1e-14);
  EXPECT_GE(largest_distance_from_surface({}), 0.05);
}

TEST(LoopSubdivision, PointsThatNoTriangleNamesAreLeftOut) {
  const std::vector<Triangle> triangles = {{1, 3, 4}};
  const Subdivision fine = subdivide_loop(6, triangles, 1);
  EXPECT_EQ(fine.weights.n_columns, 6u);
  EXPECT_EQ(fine.weights.n_rows(), 6u);
  EXPECT_EQ(std::set<std::uint32_t>(fine.weights.column.begin(), fine.weights.column.end()),
            (std::set<std::uint32_t>{1, 3, 4}));
  // points first: corner 1 keeps 3/4, as the boundary rule says
  EXPECT_EQ(fine.weights.column[fine.weights.row_start[0]], 1u);
  EXPECT_EQ(fine.weights.weight[fine.weights.row_start[0]], 0.75);
}

TEST(LoopSubdivision, RefusesWhatIsNoSurface) {
  const std::vector<Triangle> fan = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, out_of_range = {{0, 1, 7}};
  const std::vector<Edge> no_edge = {{2, 3}}, unused = {{0, 5}};
  const std::vector<Triangle> two = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_THROW(subdivide_loop(5, fan, 1), UsageError);
  EXPECT_THROW(subdivide_loop(5, out_of_range, 1), UsageError);
  EXPECT_THROW(subdivide_loop(4, two, 1, no_edge), UsageError);
  EXPECT_THROW(subdivide_loop(6, two, 1, unused), UsageError);
}

}  // namespace
}  // namespace pvg
