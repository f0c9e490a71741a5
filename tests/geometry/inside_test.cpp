// Points in and around a box, by hand.
#include "host/geometry/inside.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/box_mesh.hpp"

namespace pvg {
namespace {

TEST(Inside, OfABoxTheNearestFaceCounts) {
  const TriangleMesh box = test::box({-1, -2, -3}, {1, 2, 3});
  EXPECT_NEAR(winding_number(box.points, box.triangles, Vec3(0.3, -1, 2)), 1, 1e-12);
  EXPECT_NEAR(winding_number(box.points, box.triangles, Vec3(1.3, -1, 2)), 0, 1e-12);
  EXPECT_NEAR(depth_inside(box, Vec3::Zero()), 1, 1e-12);
  EXPECT_NEAR(depth_inside(box, Vec3(0.2, 1.9, -0.3)), 0.1, 1e-12);
  EXPECT_NEAR(depth_inside(box, Vec3(-0.95, -1.9, 2.8)), 0.05, 1e-12);
  EXPECT_EQ(depth_inside(box, Vec3(0, 0, 3.1)), 0);
  EXPECT_EQ(depth_inside(box, Vec3(5, 5, 5)), 0);
}

TEST(Inside, AnOpenSurfaceHasNoInside) {
  TriangleMesh bowl = test::box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  std::erase_if(bowl.triangles, [&](const Triangle& t) {
    return bowl.points[t[0]].z() > 0.4 && bowl.points[t[1]].z() > 0.4 && bowl.points[t[2]].z() > 0.4;
  });
  ASSERT_EQ(bowl.triangles.size(), 10u);
  EXPECT_LT(winding_number(bowl.points, bowl.triangles, Vec3::Zero()), 0.9);
}

}  // namespace
}  // namespace pvg
