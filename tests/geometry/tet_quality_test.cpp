#include "host/geometry/tet_quality.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

TetMesh one(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  TetMesh mesh;
  mesh.nodes_per_element = 4;
  mesh.points = {a, b, c, d};
  mesh.elements = {0, 1, 2, 3};
  return mesh;
}

TEST(TetQuality, OfARegularTetrahedronAndOfASliver) {
  const TetQuality regular = tet_quality(one({1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}));
  EXPECT_NEAR(regular.least_dihedral, std::acos(1 / 3.0), 1e-12);
  EXPECT_NEAR(regular.largest_radius_edge, std::sqrt(6) / 4, 1e-12);
  EXPECT_EQ(regular.n_slivers, 0u);
  // four corners of a square, one pair of opposite ones lifted by h: between faces that share a side
  const double h = 0.01;
  const TetQuality flat = tet_quality(one({1, 0, 0}, {0, 1, h}, {-1, 0, 0}, {0, -1, h}));
  EXPECT_NEAR(flat.least_dihedral, 2 * std::asin(h / std::sqrt(1 + h * h) / std::sqrt(2)), 1e-4);
  EXPECT_EQ(flat.n_slivers, 1u);
}

TEST(TetQuality, ACornerOfACubeHasRightAngles) {
  const TetQuality corner = tet_quality(one({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  EXPECT_NEAR(corner.least_dihedral, std::acos(1 / std::sqrt(3)), 1e-12);
  EXPECT_NEAR(corner.largest_radius_edge, std::sqrt(3) / 2, 1e-12);
}

}  // namespace
}  // namespace pvg
