// Parts of a surface that share space count twice in its mass; parts that are apart or touch do not.
#include "host/geometry/mesh_parts.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/box_mesh.hpp"

namespace pvg {
namespace {

TriangleMesh unit_box() { return test::box(Vec3::Zero(), Vec3::Ones()); }

TriangleMesh two_boxes(const Vec3& offset, double scale) {
  const TriangleMesh box = unit_box();
  TriangleMesh mesh = box;
  const std::uint32_t first = std::uint32_t(box.points.size());
  for (const Vec3& p : box.points) mesh.points.push_back(scale * p + offset);
  for (const Triangle& t : box.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return mesh;
}

TEST(MeshParts, OneBoxAndTwoApartOverlapNowhere) {
  EXPECT_FALSE(has_overlapping_parts(unit_box()));
  EXPECT_FALSE(has_overlapping_parts(two_boxes(Vec3(5, 0, 0), 1)));
  EXPECT_FALSE(has_overlapping_parts({}));
}

TEST(MeshParts, BoxesThatShareSpaceOverlap) {
  EXPECT_TRUE(has_overlapping_parts(two_boxes(Vec3(0.3, 0.2, 0.1), 1)));
  EXPECT_TRUE(has_overlapping_parts(two_boxes(Vec3::Zero(), 1)));              // one on the other
  EXPECT_TRUE(has_overlapping_parts(two_boxes(Vec3(0.25, 0.25, 0.25), 0.5)));  // one in the other
}

}  // namespace
}  // namespace pvg
