// Planes of surfaces whose planes are known.
#include "host/capture/planes.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/geometry/primitive_shapes.hpp"

namespace pvg {
namespace {

using Pose = Eigen::Isometry3d;

struct Surface {
  std::vector<Vec3f> points;
  std::vector<Triangle> triangles;

  void add_sheet(const Pose& pose, double width, double height, double noise, std::mt19937& random) {
    std::normal_distribution<double> error(0, noise);
    const TriangleMesh sheet = sheet_surface({width, height}, {int(width / 0.01), int(height / 0.01)});
    Vec3 center = Vec3::Zero();
    for (const Vec3& p : sheet.points) center += p / double(sheet.points.size());
    const std::uint32_t first = std::uint32_t(points.size());
    for (const Vec3& p : sheet.points)
      points.push_back((pose * Vec3(p - center + error(random) * Vec3::UnitZ())).cast<float>());
    for (const Triangle& t : sheet.triangles) triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
};

TEST(Planes, ATableAboveAFloorIsTwoPlanesWithTheirSizes) {
  std::mt19937 random(1);
  Surface surface;
  Pose floor = Pose::Identity(), table = Pose::Identity();
  table.translation() = Vec3(0.3, 0.1, 0.74);
  table.linear() = Eigen::AngleAxisd(0.4, Vec3::UnitZ()).toRotationMatrix();
  surface.add_sheet(floor, 2.4, 1.6, 0.001, random);
  surface.add_sheet(table, 1.2, 0.6, 0.001, random);
  const std::vector<CapturedPlane> planes = find_planes(surface.points, surface.triangles, {});
  ASSERT_EQ(planes.size(), 2u);
  EXPECT_NEAR(planes[0].pose.translation().z(), 0, 2e-4);
  EXPECT_NEAR(planes[1].pose.translation().z(), 0.74, 2e-4);
  for (const CapturedPlane& p : planes) EXPECT_GT(p.pose.linear()(2, 2), 0.99999);
  EXPECT_NEAR(planes[0].width, 2.4, 0.06);
  EXPECT_NEAR(planes[0].height, 1.6, 0.06);
  EXPECT_NEAR(planes[1].width, 1.2, 0.06);
  EXPECT_NEAR(planes[1].height, 0.6, 0.06);
  EXPECT_NEAR(std::abs(planes[1].pose.linear().col(0).dot(table.linear().col(0))), 1, 1e-3);
  // a facet's centre is the mean of three points
  EXPECT_NEAR(planes[1].roughness, 0.001 / std::sqrt(3.0), 1e-4);
}

TEST(Planes, TwoShelvesOfOneHeightAreTwoPlanes) {
  std::mt19937 random(2);
  Surface surface;
  Pose left = Pose::Identity(), right = Pose::Identity();
  left.translation().x() = -1;
  right.translation().x() = 1;
  surface.add_sheet(left, 0.8, 0.5, 0.0005, random);
  surface.add_sheet(right, 0.8, 0.5, 0.0005, random);
  EXPECT_EQ(find_planes(surface.points, surface.triangles, {}).size(), 2u);
}

// the mean of a cube's facets lies on none of them
TEST(Planes, ARoughSurfaceHasNone) {
  std::mt19937 random(3);
  Surface surface;
  surface.add_sheet(Pose::Identity(), 0.5, 0.5, 0.01, random);
  PlaneSettings exact;
  exact.distance = 1e-9;
  EXPECT_TRUE(find_planes(surface.points, surface.triangles, exact).empty());
}

}  // namespace
}  // namespace pvg
