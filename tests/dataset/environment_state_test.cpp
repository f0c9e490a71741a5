// Keypoints of cloths and the names of what a policy sees of objects and cloths.
#include "host/dataset/environment_state.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

// 5 x 3 points, 0.1 m apart in the plane of two axes, from (-1, 2) on; the third axis is 0.
std::vector<Vec3> sheet(int u, int v) {
  std::vector<Vec3> points;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 5; ++i) {
      Vec3 point = Vec3::Zero();
      point[u] = -1 + 0.1 * i;
      point[v] = 2 + 0.1 * j;
      points.push_back(point);
    }
  return points;
}

TEST(EnvironmentState, KeypointsGoAroundTheClothFromItsLeastCorner) {
  const std::array<std::size_t, 8> around = {0, 2, 4, 9, 14, 12, 10, 5};
  EXPECT_EQ(cloth_keypoints("towel", sheet(0, 1)).vertices, around);
  EXPECT_EQ(cloth_keypoints("curtain", sheet(1, 2)).vertices, around);  // hangs in the plane of y and z
  EXPECT_EQ(cloth_keypoints("curtain", sheet(0, 2)).vertices, around);
  // v is the longer side here: 3 points along u, 5 along v
  EXPECT_EQ(cloth_keypoints("scarf", sheet(1, 0)).vertices, (std::array<std::size_t, 8>{0, 5, 10, 12, 14, 9, 4, 2}));
}

TEST(EnvironmentState, ThePointNearestToACornerCountsWhereNoneIsThere) {
  std::vector<Vec3> points = sheet(0, 1);
  points[4].x() -= 0.02;  // a rounded corner
  points[4].y() += 0.01;
  const ClothKeypoints towel = cloth_keypoints("towel", points);
  EXPECT_EQ(towel.vertices[2], 4u);
  const std::vector<Vec3> now(points.size(), Vec3(7, 8, 9));
  points[4] = Vec3(0.1, 0.2, 0.3);
  const auto numbers = keypoint_numbers(towel, points);
  EXPECT_EQ((std::array<double, 3>{numbers[6], numbers[7], numbers[8]}), (std::array<double, 3>{0.1, 0.2, 0.3}));
  EXPECT_EQ(keypoint_numbers(towel, now)[23], 9);
}

TEST(EnvironmentState, NamesTellWhichNumbersAreLengths) {
  const std::vector<std::string> objects = {"left/cup"};
  const std::vector<ClothKeypoints> cloths = {{"towel", {}}};
  const std::vector<EnvironmentColumn> columns = environment_columns(objects, cloths);
  ASSERT_EQ(columns.size(), 31u);
  EXPECT_EQ(columns[2].name, "left_cup_z");
  EXPECT_TRUE(columns[2].is_length);
  EXPECT_EQ(columns[6].name, "left_cup_qw");
  EXPECT_FALSE(columns[6].is_length);
  EXPECT_EQ(columns[7].name, "towel_corner_0_x");
  EXPECT_EQ(columns[30].name, "towel_edge_3_z");
  EXPECT_TRUE(columns[30].is_length);
}

}  // namespace
}  // namespace pvg
