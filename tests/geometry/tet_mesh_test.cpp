// Tetrahedral meshes: boundary, volumes, the step to ten nodes, and masses.
#include "host/geometry/tet_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <numeric>
#include <set>

namespace pvg {
namespace {

// a box of n x n x n cells of 1 cm, each cut into the six tetrahedra along its main diagonal
TetMesh box(int n) {
  TetMesh mesh;
  mesh.nodes_per_element = 4;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.points.push_back(0.01 * Vec3(i, j, k));
  const auto at = [n](const Eigen::Vector3i& c) { return std::uint32_t((c(2) * (n + 1) + c(1)) * (n + 1) + c(0)); };
  const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int cell = 0; cell < n * n * n; ++cell) {
    const Eigen::Vector3i corner(cell % n, cell / n % n, cell / n / n);
    for (int o = 0; o < 6; ++o) {
      const Eigen::Vector3i first = corner + Eigen::Vector3i::Unit(orders[o][0]),
                            second = first + Eigen::Vector3i::Unit(orders[o][1]);
      const std::uint32_t nodes[4] = {at(corner), at(first), at(second), at(corner + Eigen::Vector3i::Ones())};
      const bool is_even = o < 3;
      for (const int k : {0, is_even ? 1 : 2, is_even ? 2 : 1, 3}) mesh.elements.push_back(nodes[k]);
    }
  }
  mesh.surface = boundary_triangles(mesh);
  return mesh;
}

// volume inside a closed surface, by the divergence theorem; right only if it is closed and looks outward
double enclosed_volume(const std::vector<Vec3>& x, const std::vector<Triangle>& surface) {
  double volume = 0;
  for (const auto& [a, b, c] : surface) volume += x[a].cross(x[b]).dot(x[c]) / 6;
  return volume;
}

bool is_closed(const std::vector<Triangle>& surface) {
  std::map<Edge, int> directed;
  for (const auto& [a, b, c] : surface) ++directed[{a, b}], ++directed[{b, c}], ++directed[{c, a}];
  for (const auto& [edge, n] : directed)
    if (n != 1 || !directed.count({edge[1], edge[0]})) return false;
  return !directed.empty();
}

TEST(TetMesh, VolumesOfABoxArePositiveAndSumToIt) {
  const TetMesh mesh = box(3);
  const std::vector<double> volumes = element_volumes(mesh);
  for (const double v : volumes) EXPECT_NEAR(v, 1e-6 / 6, 1e-18);
  EXPECT_NEAR(std::accumulate(volumes.begin(), volumes.end(), 0.0), 27e-6, 1e-16);
}

TEST(TetMesh, AMirroredElementHasNegativeVolume) {
  TetMesh mesh = box(1);
  std::swap(mesh.elements[1], mesh.elements[2]);
  EXPECT_NEAR(element_volumes(mesh)[0], -1e-6 / 6, 1e-18);
}

TEST(TetMesh, BoundaryOfLinearAndQuadraticBoxesIsClosedAndLooksOutward) {
  const TetMesh linear = box(2), quadratic = make_quadratic(linear);
  EXPECT_EQ(linear.surface.size(), 6u * 2 * 4);  // 6 sides of 2 x 2 squares of 2 triangles
  EXPECT_EQ(quadratic.surface.size(), 4 * linear.surface.size());
  for (const TetMesh* mesh : {&linear, &quadratic}) {
    EXPECT_TRUE(is_closed(mesh->surface));
    EXPECT_NEAR(enclosed_volume(mesh->points, mesh->surface), 8e-6, 1e-17);
  }
}

TEST(TetMesh, QuadraticNodesLieInTheMiddleOfTheirEdges) {
  const TetMesh linear = box(2), mesh = make_quadratic(linear);
  const int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  ASSERT_EQ(mesh.nodes_per_element, 10);
  ASSERT_EQ(mesh.n_elements(), linear.n_elements());
  for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
    const std::uint32_t* n = &mesh.elements[10 * e];
    for (int k = 0; k < 4; ++k) EXPECT_EQ(n[k], linear.elements[4 * e + k]);
    for (int k = 0; k < 6; ++k)
      EXPECT_LE((mesh.points[n[4 + k]] - (mesh.points[n[edges[k][0]]] + mesh.points[n[edges[k][1]]]) / 2).norm(),
                1e-17);
  }
  // each node once: 3^3 corners of the cells and 98 edges
  EXPECT_EQ(mesh.points.size(), 125u);
  EXPECT_EQ(std::set<std::uint32_t>(mesh.elements.begin(), mesh.elements.end()).size(), 125u);
}

TEST(TetMesh, RefinementKeepsTheBodyAndItsBoundary) {
  const TetMesh coarse = box(2), fine = refine(coarse);
  EXPECT_EQ(fine.n_elements(), 8 * coarse.n_elements());
  for (const double v : element_volumes(fine)) EXPECT_NEAR(v, 1e-6 / 48, 1e-18);
  EXPECT_EQ(fine.surface.size(), 4 * coarse.surface.size());  // no gaps between neighbours
  EXPECT_TRUE(is_closed(fine.surface));
  EXPECT_NEAR(enclosed_volume(fine.points, fine.surface), 8e-6, 1e-17);
}

TEST(TetMesh, NodeMassesArePositiveAndSumToTheBody) {
  for (const TetMesh& mesh : {box(2), make_quadratic(box(2))}) {
    const std::vector<double> masses = node_masses(mesh, 1200);
    for (const double m : masses) EXPECT_GT(m, 0);
    EXPECT_NEAR(std::accumulate(masses.begin(), masses.end(), 0.0), 1200 * 8e-6, 1e-15);
  }
}

// one element: 1/36 of its mass at a corner, 4/27 at a midpoint
TEST(TetMesh, MassOfATenNodeElementIsSharedByItsConsistentDiagonal) {
  TetMesh one;
  one.nodes_per_element = 4;
  one.points = {{0, 0, 0}, {0.6, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  one.elements = {0, 1, 2, 3};
  const std::vector<double> masses = node_masses(make_quadratic(one), 1080);  // 108 kg
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(masses[k], 3, 1e-12);
  for (int k = 4; k < 10; ++k) EXPECT_NEAR(masses[k], 16, 1e-12);
}

}  // namespace
}  // namespace pvg
