// Closed surfaces around broken ones.
#include "host/capture/objects/wrap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/base/error.hpp"
#include "host/capture/fusion.hpp"
#include "host/capture/objects/object.hpp"
#include "host/capture/objects/surface_distance.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "host/geometry/segment_distance.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

constexpr double RADIUS = 0.05;

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b, const Vec3& shift) {
  const std::uint32_t first = std::uint32_t(a.points.size());
  for (const Vec3& p : b.points) a.points.push_back(p + shift);
  for (const Triangle& t : b.triangles) a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return a;
}

// one way of breaking a ball for each kind
TriangleMesh broken(int kind, std::mt19937& random) {
  TriangleMesh mesh = sphere_surface(RADIUS, 3);
  std::vector<Triangle> kept;
  switch (kind) {
    case 0:  // holes
      for (const Triangle& t : mesh.triangles)
        if (random() % 20) kept.push_back(t);
      mesh.triangles = kept;
      break;
    case 1:  // flipped
      for (Triangle& t : mesh.triangles)
        if (random() % 2) std::swap(t[1], t[2]);
      break;
    case 2:  // doubled
      mesh = joined(mesh, mesh, Vec3::Zero());
      break;
    case 3:  // self-crossing
      mesh = joined(mesh, sphere_surface(RADIUS, 3), Vec3(0.03, 0.01, 0));
      break;
    case 4:  // non-manifold: fins
      for (int i = 0; i < 20; ++i) {
        const Triangle t = mesh.triangles[random() % mesh.triangles.size()];
        mesh.points.push_back(1.2 * mesh.points[t[0]]);
        mesh.triangles.push_back({t[0], t[1], std::uint32_t(mesh.points.size() - 1)});
      }
      break;
    case 5: {  // noise
      std::normal_distribution<double> noise(0, 5e-4);
      for (Vec3& p : mesh.points) p += Vec3(noise(random), noise(random), noise(random));
      break;
    }
    case 6:  // several shells, one in another
      mesh = joined(mesh, sphere_surface(0.6 * RADIUS, 2), Vec3::Zero());
      mesh = joined(mesh, sphere_surface(0.3 * RADIUS, 2), Vec3(0.12, 0, 0));
      break;
    default:  // a soup: no point is shared
      TriangleMesh soup;
      for (const Triangle& t : mesh.triangles) {
        const std::uint32_t first = std::uint32_t(soup.points.size());
        for (const std::uint32_t corner : t) soup.points.push_back(mesh.points[corner]);
        soup.triangles.push_back({first, first + 1, first + 2});
      }
      return soup;
  }
  return mesh;
}

TEST(NearestTriangle, IsTheNearestOfAll) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> anywhere(-0.1, 0.1);
  const TriangleMesh mesh = sphere_surface(RADIUS, 2);
  const NearestTriangle nearest(mesh);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p(anywhere(random), anywhere(random), anywhere(random));
    double best = INFINITY;
    for (const Triangle& t : mesh.triangles)
      best = std::min(best, point_triangle_distance(p, mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
    ASSERT_EQ(nearest.distance(p), best);
  }
}

TEST(Wrap, EveryBrokenBallBecomesAClosedOneNearIt) {
  std::mt19937 random(11);
  WrapSettings settings;
  settings.spacing = RADIUS / 20;
  for (int kind = 0; kind < 8; ++kind) {
    const TriangleMesh source = broken(kind, random);
    const TriangleMesh wrapped = wrap_surface(source, settings);
    EXPECT_EQ(closed_surface_defect(wrapped), std::nullopt) << "kind " << kind;
    EXPECT_TRUE(is_sound(wrapped)) << "kind " << kind;
    // outside by the offset; over a hole by less than what the ball sinks in, in the clefts beside a fin by the bridge
    EXPECT_LE(surface_distances(wrapped, source).back(), (kind == 4 ? 4 : 2) * settings.spacing) << "kind " << kind;
    const double volume = enclosed_volume(wrapped) / (4.0 / 3 * M_PI * std::pow(RADIUS, 3));
    if (kind != 3 && kind != 6) {
      EXPECT_NEAR(volume, std::pow(1 + 0.6 / 20, 3), 0.05) << "kind " << kind;
    }
    const TriangleMesh fewer = simplified_solid(wrapped, 300, 2 * settings.spacing).mesh;
    EXPECT_TRUE(is_sound(fewer)) << "kind " << kind;
    EXPECT_LE(fewer.triangles.size(), kind == 6 ? 600u : 300u) << "kind " << kind;
    EXPECT_LE(surface_distances(fewer, wrapped).back(), 2 * settings.spacing) << "kind " << kind;
  }
}

// a ball of this radius around the origin without what is nearer to the z axis than `hole` at its top
TriangleMesh ball_with_hole(double radius, double hole) {
  constexpr std::uint32_t SECTORS = 24, RINGS = 12;
  TriangleMesh mesh;
  for (std::uint32_t ring = 0; ring <= RINGS; ++ring)
    for (std::uint32_t k = 0; k < SECTORS; ++k) {
      const double first = std::asin(hole / radius), polar = first + (0.999 * M_PI - first) * ring / RINGS;
      const double azimuth = 2 * M_PI * k / SECTORS;
      mesh.points.push_back(
          radius * Vec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)));
      const std::uint32_t a = ring * SECTORS + k, b = ring * SECTORS + (k + 1) % SECTORS;
      if (ring < RINGS)
        mesh.triangles.insert(mesh.triangles.end(), {{a, a + SECTORS, b + SECTORS}, {a, b + SECTORS, b}});
    }
  return mesh;
}

// A hole of w = 3.9 mm radius: the ball of B = 4 mm does not enter, but sinks in by B - sqrt(B^2 - w^2) = 3.1 mm, so
// that the middle of its cap is sqrt(w^2 + 3.1^2) = 5 mm from the rim, and a sample of 0.4 mm less: more than the
// bridge. Balls of 0.93^k B are tried, k < 4; that of 3.46 mm enters along samples that are up to 0.28 mm off the axis,
// and leaves the hole open.
TEST(Object, AHoleThatCannotBeBridgedWithinTheBoundIsLeftOpenByASmallerBall) {
  ObjectSource source;
  source.name = "ball";
  source.mesh = ball_with_hole(8e-3, 3.9e-3);
  ObjectSettings settings;
  settings.wrap = {0.4e-3, 0, 4e-3};
  const CapturedObject open = capture_object(source, settings);
  EXPECT_DOUBLE_EQ(open.bound, 4e-3);
  EXPECT_LE(open.bridge, 0.93 * 4e-3);
  EXPECT_GE(open.bridge, 0.93 * 0.93 * 0.93 * 4e-3);
  EXPECT_LE(open.to_source.back(), 1.2e-3);  // two details and the offset of 0.6
  source.mesh = ball_with_hole(8e-3, 2e-3);  // sinks in by 0.54 mm: 2.1 mm from the rim
  const CapturedObject object = capture_object(source, settings);
  EXPECT_DOUBLE_EQ(object.bound, 4e-3);
  EXPECT_DOUBLE_EQ(object.bridge, 4e-3);
  EXPECT_NEAR(object.to_source.back(), 2.1e-3, 0.6e-3);  // a sample and half of one
}

TEST(Wrap, APartWithinAnotherOneIsNotSound) {
  const TriangleMesh ball = sphere_surface(RADIUS, 2), small = sphere_surface(0.4 * RADIUS, 1);
  EXPECT_FALSE(is_sound(joined(ball, small, Vec3(0.01, 0, 0))));
  EXPECT_TRUE(is_sound(joined(ball, small, Vec3(0.08, 0, 0))));
}

TEST(SurfaceDistances, LookAlsoBetweenThePointsOfALargeTriangle) {
  // the nearest place of a square to a point below its middle is the middle of its diagonal: neither a corner (sqrt 3)
  // nor the middle of a triangle
  TriangleMesh square;
  square.points = {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  TriangleMesh point;
  point.points = {{-1e-6, 0, 0}, {1e-6, 0, 0}, {0, 1e-6, 0}};
  point.triangles = {{0, 1, 2}};
  EXPECT_NEAR(surface_distances(square, point).front(), 1, 1e-5);
  EXPECT_NEAR(surface_distances(square, point).back(), std::sqrt(3.0), 1e-5);
}

TEST(Wrap, ASurfaceThatIsThereTwiceIsNotSound) {
  TriangleMesh mesh = sphere_surface(RADIUS, 1);
  EXPECT_TRUE(is_sound(mesh));
  mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.begin() + 80);
  EXPECT_FALSE(is_sound(mesh));
}

TEST(Wrap, ASheetWithoutThicknessIsNotLost) {
  TriangleMesh sheet = sheet_surface({0.1, 0.06}, {10, 6});
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Vec3(1, 2, 0.5).normalized()).toRotationMatrix();
  for (Vec3& p : sheet.points) p = turn * p;
  WrapSettings settings;
  settings.spacing = 1e-3;
  const TriangleMesh wrapped = wrap_surface(sheet, settings);
  EXPECT_TRUE(is_sound(wrapped));
  EXPECT_LE(surface_distances(sheet, wrapped).back(), 1e-3);  // 0.6 mm, and where the samples are
  EXPECT_NEAR(enclosed_volume(wrapped), 0.1 * 0.06 * 1.2e-3, 0.25 * 0.1 * 0.06 * 1.2e-3);
}

// What the wrap relies on where triangles of one cell would meet.
TEST(MarchingCubes, WithPointsInTheMiddlesOfTheEdgesNoTrianglesOfACellMeet) {
  const std::vector<std::uint8_t> cases = marching_cubes_cases();
  const auto middle = [](std::uint8_t edge) {
    const int axis = edge / 4, low = edge & 1, high = edge >> 1 & 1;
    return Vec3(axis == 0 ? 0.5 : low, axis == 1 ? 0.5 : axis == 0 ? low : high, axis == 2 ? 0.5 : high);
  };
  for (std::size_t which = 0; which < 256; ++which) {
    TriangleMesh cell;
    for (std::uint8_t edge = 0; edge < 12; ++edge) cell.points.push_back(middle(edge));
    for (std::size_t k = 16 * which; cases[k] != 255; k += 3)
      cell.triangles.push_back({cases[k], cases[k + 1], cases[k + 2]});
    EXPECT_FALSE(find_intersection(cell.points, cell.triangles)) << "case " << which;
  }
}

// A tube of 40 sectors, 60 mm wide with a wall of 4 mm, and fins that stand off it at any angle: in the clefts beside
// them two sheets of the wrap pass through one cell. Of the first four seeds the last one's surface met itself there.
TEST(Wrap, ClosesNarrowCleftsWithoutCrossingItself) {
  constexpr std::uint32_t SECTORS = 40;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  TriangleMesh tube;
  for (std::uint32_t k = 0; k < SECTORS; ++k)
    for (const double radius : {0.03, 0.034})
      for (const double z : {-0.04, 0.04})
        tube.points.push_back(
            {radius * std::cos(2 * M_PI * k / SECTORS), radius * std::sin(2 * M_PI * k / SECTORS), z});
  for (std::uint32_t k = 0; k < SECTORS; ++k)
    for (const std::array<std::uint32_t, 2> side : {std::array{1u, 0u}, {2u, 3u}, {0u, 2u}, {3u, 1u}}) {
      const std::uint32_t a = 4 * k, b = 4 * ((k + 1) % SECTORS);
      tube.triangles.insert(tube.triangles.end(),
                            {{a + side[0], a + side[1], b + side[1]}, {a + side[0], b + side[1], b + side[0]}});
    }
  for (int i = 0; i < 15; ++i) {
    const Triangle t = tube.triangles[random() % (8 * SECTORS)];
    tube.points.push_back(1.15 * tube.points[t[0]]);
    tube.triangles.push_back({t[0], t[1], std::uint32_t(tube.points.size() - 1)});
  }
  const Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
  for (Vec3& p : tube.points) p = turn.normalized() * p;
  WrapSettings settings;
  settings.spacing = 2.27e-3;
  const TriangleMesh wrapped = wrap_surface(tube, settings);
  EXPECT_TRUE(is_sound(wrapped));
  EXPECT_LE(surface_distances(wrapped, tube).back(), 4 * settings.spacing);
}

TEST(Wrap, WhatIsNoMeshIsRefused) {
  expect_error<UsageError>([] { wrap_surface({}, {}); }, {"no triangles"});
  TriangleMesh mesh = sphere_surface(1, 1);
  mesh.points[3].x() = NAN;
  expect_error<UsageError>([&] { wrap_surface(mesh, {0.1, 0, 0}); }, {"not finite"});
  mesh.points[3].x() = 0;
  expect_error<UsageError>([&] { wrap_surface(mesh, {1e-4, 0, 0}); }, {"--detail"});
}

}  // namespace
}  // namespace pvg
