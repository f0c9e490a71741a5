// Things on a table are cut out of the surface that they and the table have together.
#include "host/capture/objects/standing_object.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

constexpr double CLEARANCE = 6e-3;  // [m]

// A table of 1 x 0.8 m as a grid of 2 mm; the height of the surface over it makes things.
template <class Height>
VisualMesh table_with(const Height& height) {
  VisualMesh mesh;
  const int nx = 500, ny = 400;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const double x = -0.5 + i * 0.002, y = -0.4 + j * 0.002;
      mesh.points.emplace_back(float(x), float(y), float(height(x, y)));
      mesh.colors.emplace_back(0.5f, 0.4f, float(0.1 * j / ny));
    }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const std::uint32_t a = std::uint32_t(j * (nx + 1) + i), b = a + 1, c = a + nx + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

// a cone of 60 mm radius and 120 mm height at (x, y): a volume that a grid has nearly right
double cone(double x, double y, double px, double py) {
  return std::max(0.0, 0.12 * (1 - std::hypot(x - px, y - py) / 0.06));
}

TriangleMesh solid_of(const VisualMesh& mesh) {
  TriangleMesh out;
  for (const Vec3f& p : mesh.points) out.points.push_back(p.cast<double>());
  out.triangles = mesh.triangles;
  return out;
}

TEST(StandingObject, AConeOnATableIsClosedBelowAndHasItsVolume) {
  const StandingThing thing = standing_thing(table_with([](double x, double y) { return cone(x, y, 0.1, -0.05); }), 1,
                                             0.8, CLEARANCE, Vec3::Zero());
  EXPECT_EQ(thing.n_things, 1u);
  double lowest = 1, highest = 0;
  for (const Vec3f& p : thing.mesh.points) {
    lowest = std::min(lowest, double(p.z()));
    highest = std::max(highest, double(p.z()));
  }
  EXPECT_EQ(lowest, 0);
  EXPECT_NEAR(highest, 0.12, 1e-6);
  EXPECT_EQ(thing.mesh.colors.size(), thing.mesh.points.size());
  // The cut lies between 6 mm, at a radius of 57 mm, and a cell's diagonal further in, 54.2 mm and 11.6 mm. Below it
  // the wall is straight: pi r^2 z + pi r^2 (120 mm - z) / 3 is 449.0 and 441.1 cm^3.
  EXPECT_GT(enclosed_volume(solid_of(thing.mesh)), 440.4e-6);
  EXPECT_LT(enclosed_volume(solid_of(thing.mesh)), 449.2e-6);
  // the foot is a convex hull: all of it lies within the circle of the cone's own foot
  for (const Vec3f& p : thing.mesh.points)
    EXPECT_LE(p.z() == 0 ? std::hypot(double(p.x()) - 0.1, double(p.y()) + 0.05) : 0.0, 0.06);
}

TEST(StandingObject, OfTwoThingsTheOneWhereTheCamerasLookIsTaken) {
  const VisualMesh both =
      table_with([](double x, double y) { return cone(x, y, -0.2, 0.1) + 1.5 * cone(x, y, 0.2, -0.1); });
  for (const double side : {-1.0, 1.0}) {
    const StandingThing thing = standing_thing(both, 1, 0.8, CLEARANCE, Vec3(0.15 * side, 0, 0.05));
    EXPECT_EQ(thing.n_things, 2u);
    for (const Vec3f& p : thing.mesh.points) EXPECT_GT(side * double(p.x()), 0.1);
  }
}

TEST(StandingObject, AnEmptyTableIsSaid) {
  const VisualMesh empty = table_with([](double, double) { return 0.001; });
  expect_error<Failure>([&] { standing_thing(empty, 1, 0.8, CLEARANCE, Vec3::Zero()); }, {"nothing stands", "6 mm"});
}

TEST(StandingObject, CamerasAroundAPointLookAtIt) {
  const Vec3 point(0.3, -0.2, 0.1);
  std::vector<CaptureFrame> frames(5);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vec3 eye(std::cos(double(i)), std::sin(double(i)), 0.5 + 0.1 * double(i)), z = (point - eye).normalized();
    Pose& pose = frames[i].depth_camera.pose;
    pose.translation() = eye;
    pose.linear().col(2) = z;
    pose.linear().col(0) = z.unitOrthogonal();
    pose.linear().col(1) = z.cross(pose.linear().col(0));
  }
  EXPECT_LE((where_cameras_look(frames) - point).norm(), 1e-12);
}

}  // namespace
}  // namespace pvg
