// Masses of closed surfaces against numbers by hand.
#include "host/geometry/mass_properties.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/box_mesh.hpp"

namespace pvg {
namespace {

using test::box;

TEST(MassProperties, BoxFarFromTheOriginHasItsTextbookInertia) {
  // 0.2 x 0.3 x 0.5 m, 700 kg/m^3: volume 0.03 m^3, mass 21 kg, inertia m/12 (b^2 + c^2)
  const MassProperties p = mass_properties(box(Vec3(1, 2, 3), Vec3(1.2, 2.3, 3.5)), 700);
  EXPECT_NEAR(p.volume, 0.03, 1e-14);
  EXPECT_NEAR(p.mass, 21, 1e-11);
  EXPECT_LT((p.center - Vec3(1.1, 2.15, 3.25)).norm(), 1e-13);
  const Eigen::Vector3d diagonal(21.0 / 12 * (0.09 + 0.25), 21.0 / 12 * (0.04 + 0.25), 21.0 / 12 * (0.04 + 0.09));
  EXPECT_LT((p.inertia - Eigen::Matrix3d(diagonal.asDiagonal())).norm(), 1e-10);  // parallel axes cancel 5 digits
}

TEST(MassProperties, CornerTetrahedronHasItsTextbookProducts) {
  // corners 0, x, y, z with unit legs, density 60: mass 10; int x^2 = 60/60 = 1, int x y = 60/120 = 1/2, centre 1/4.
  // about the centre: Ixx = 2 (1 - 10/16) = 0.75, Ixy = -(1/2 - 10/16) = 0.125
  TriangleMesh mesh;
  mesh.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const MassProperties p = mass_properties(mesh, 60);
  EXPECT_NEAR(p.mass, 10, 1e-13);
  EXPECT_LT((p.center - Vec3::Constant(0.25)).norm(), 1e-15);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(p.inertia(i, j), i == j ? 0.75 : 0.125, 1e-13);
  }
}

TEST(MassProperties, CavityIsTakenAway) {
  TriangleMesh mesh = box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const TriangleMesh hole = box(Vec3(0.5, 0.25, 0.25), Vec3(0.9, 0.75, 0.75));
  for (const Triangle& t : hole.triangles) mesh.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
  mesh.points.insert(mesh.points.end(), hole.points.begin(), hole.points.end());
  const MassProperties p = mass_properties(mesh, 10);
  EXPECT_NEAR(p.mass, 9, 1e-12);  // 10 - 10 x 0.1
  EXPECT_NEAR(p.center.x(), (10 * 0.5 - 1 * 0.7) / 9, 1e-12);
}

}  // namespace
}  // namespace pvg
