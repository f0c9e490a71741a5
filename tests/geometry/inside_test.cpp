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

// a board 12 mm thick, whose middle is 6 mm deep, and one of 50 mm
TEST(Inside, AWayThroughABoardIsNoneAlongIt) {
  const TriangleMesh thin = test::box({-0.5, -0.5, -0.012}, {0.5, 0.5, 0}),
                     thick = test::box({-0.5, -0.5, -0.05}, {0.5, 0.5, 0});
  const auto passes = [](const TriangleMesh& board, std::vector<Vec3> way) { return passes_through(board, way, 0.01); };
  const std::vector<Vec3> down = {{0, 0, 0.2}, {0.05, 0, -0.2}},
                          along = {{-0.3, 0, 0.2}, {-0.2, 0, 0.001}, {0.2, 0, 0}},
                          skims = {{-0.3, 0, 0.2}, {-0.2, 0, -0.007}, {0.2, 0, -0.007}, {0.2, 0, 0.2}},
                          clips = {{-0.6, 0, -0.004}, {0.6, 0, 0.002}}, below = {{0, 0, -0.2}, {0.4, 0, -0.06}},
                          away = {{0, 0, -0.02}, {0, 0, 0.2}};
  for (const TriangleMesh* board : {&thin, &thick}) {
    EXPECT_TRUE(passes(*board, down));
    EXPECT_TRUE(passes(*board, {down[1], down[0]}));
    EXPECT_FALSE(passes(*board, along));
    EXPECT_FALSE(passes(*board, clips));
    EXPECT_FALSE(passes(*board, below));
    EXPECT_FALSE(passes(*board, {down[0]}));
  }
  // it begins and ends where the check of targets alone counts
  EXPECT_FALSE(passes(thick, skims));
  EXPECT_FALSE(passes(thick, away));
  EXPECT_TRUE(passes(thick, {{0, 0, 0.2}, {0, 0, -0.02}, {0, 0, 0.2}}));
  // a sheet of less than 10 mm yields
  EXPECT_FALSE(passes(test::box({-0.5, -0.5, -0.005}, {0.5, 0.5, 0}), down));
}

}  // namespace
}  // namespace pvg
