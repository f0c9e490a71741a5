// Surfaces that are fit for simulation pass, each defect is named with its place.
#include "host/geometry/mesh_checks.hpp"

#include <cmath>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"
#include "tests/geometry/box_mesh.hpp"

namespace pvg {
namespace {

using test::box;

TriangleMesh flipped(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto first = std::uint32_t(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

void expect_defect(const TriangleMesh& mesh, std::initializer_list<const char*> words) {
  expect_error<UsageError>([&] { check_closed_surface(mesh, "part.obj"); }, words);
}

const TriangleMesh UNIT_BOX = box(Vec3(0, 0, 0), Vec3(1, 1, 1));

TEST(MeshChecks, ClosedOutwardBoxPasses) {
  EXPECT_EQ(closed_surface_defect(UNIT_BOX), std::nullopt);
  EXPECT_DOUBLE_EQ(enclosed_volume(UNIT_BOX), 1);
}

TEST(MeshChecks, HoleIsCountedAndPlaced) {
  TriangleMesh mesh = UNIT_BOX;
  mesh.triangles.pop_back();
  expect_defect(mesh, {"part.obj", "holes", "3 edges", "(1, 0, 0)", "close"});
}

TEST(MeshChecks, OneFlippedTriangleIsNamed) {
  TriangleMesh mesh = UNIT_BOX;
  std::swap(mesh.triangles[4][0], mesh.triangles[4][1]);
  expect_defect(mesh, {"flipped triangles", "3 edges", "orientation"});
}

TEST(MeshChecks, InsideOutSolidIsNamed) { expect_defect(flipped(UNIT_BOX), {"facing inward", "flip them"}); }

TEST(MeshChecks, InsideOutPartBesideAGoodOneIsNamed) {
  expect_defect(joined(UNIT_BOX, flipped(box(Vec3(3, 0, 0), Vec3(3.5, 0.5, 0.5)))), {"facing inward", "3.25"});
}

TEST(MeshChecks, CavityPasses) {
  const TriangleMesh hollow = joined(UNIT_BOX, flipped(box(Vec3(0.25, 0.25, 0.25), Vec3(0.75, 0.75, 0.75))));
  EXPECT_EQ(closed_surface_defect(hollow), std::nullopt);
  EXPECT_DOUBLE_EQ(enclosed_volume(hollow), 0.875);
}

TEST(MeshChecks, NotANumberIsNamedWithItsVertex) {
  TriangleMesh mesh = UNIT_BOX;
  mesh.points[5].y() = NAN;
  expect_defect(mesh, {"vertex 5", "nan", "not a finite"});
}

TEST(MeshChecks, TriangleWithoutAreaIsNamed) {
  TriangleMesh mesh = UNIT_BOX;
  mesh.points.emplace_back(0.5, 0, 0);
  mesh.triangles.push_back({0, 1, 8});
  expect_defect(mesh, {"triangle 12", "no area"});
}

TEST(MeshChecks, BoxesThatTouchAlongAnEdgePass) {
  // after welding the edge has four triangles, two in each direction: still a closed surface
  const TriangleMesh touching = weld_points(joined(UNIT_BOX, box(Vec3(1, 1, 0), Vec3(2, 2, 1))), 1e-9);
  EXPECT_EQ(touching.points.size(), 14u);
  EXPECT_EQ(closed_surface_defect(touching), std::nullopt);
}

TEST(MeshChecks, WallBetweenTwoCellsIsNamed) {
  TriangleMesh mesh;  // two tetrahedra on either side of one shared triangle
  mesh.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 1}, {0, 2, 4}, {1, 4, 2}};
  expect_defect(mesh, {"3 edges", "more than two triangles"});
}

TEST(MeshChecks, EmptyMeshAndWildIndexAreNamed) {
  expect_defect({}, {"no triangles"});
  TriangleMesh mesh = UNIT_BOX;
  mesh.triangles[2][1] = 99;
  expect_defect(mesh, {"triangle 2", "99", "only 8"});
}

TEST(MeshChecks, WeldingClosesASoupOfTriangles) {
  TriangleMesh soup;
  for (const Triangle& t : UNIT_BOX.triangles) {
    for (const std::uint32_t corner : t)
      soup.points.push_back(UNIT_BOX.points[corner] + Vec3(1e-10, 0, 0) * double(corner % 2));
    const auto n = std::uint32_t(soup.points.size());
    soup.triangles.push_back({n - 3, n - 2, n - 1});
  }
  EXPECT_TRUE(closed_surface_defect(soup));
  const TriangleMesh welded = weld_points(soup, 1e-8);
  EXPECT_EQ(welded.points.size(), 8u);
  EXPECT_EQ(welded.triangles.size(), 12u);
  EXPECT_EQ(closed_surface_defect(welded), std::nullopt);
}

TEST(MeshChecks, WeldingKeepsPointsThatAreFurtherApart) {
  const TriangleMesh two = joined(UNIT_BOX, box(Vec3(1.001, 0, 0), Vec3(2, 1, 1)));
  EXPECT_EQ(weld_points(two, 1e-4).points.size(), 16u);
  EXPECT_EQ(weld_points(two, 2e-3).points.size(), 12u);
}

TEST(MeshChecks, ComponentsAreNumberedInOrder) {
  const std::vector<int> of = triangle_components(joined(UNIT_BOX, box(Vec3(3, 0, 0), Vec3(4, 1, 1))));
  for (std::size_t i = 0; i < of.size(); ++i) EXPECT_EQ(of[i], i < 12 ? 0 : 1);
}

TEST(MeshChecks, WeldingDoesNotMindHowFarAwayAMeshIs) {
  // in tolerances from the origin these places are no 64-bit numbers
  const Vec3 far(1e12, 0, 0);
  TriangleMesh mesh{{far, far + Vec3(1, 0, 0), far + Vec3(0, 1, 0), far, far + Vec3(0, 0, 1)}, {{0, 1, 2}, {3, 4, 1}}};
  const TriangleMesh welded = weld_points(mesh, 1e-9);
  EXPECT_EQ(welded.points.size(), 4u);
  EXPECT_EQ(welded.triangles.size(), 2u);
}

}  // namespace
}  // namespace pvg
