// Tetrahedra fill exactly the given surface, the same ones each time; without the program the message says what to
// install.
#include "host/formats/tetgen.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "host/base/error.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/geometry/tet_mesh.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

TriangleMesh finger() { return read_closed_surface(std::string(PVG_DATA_FOLDER) + "/grippers/umi_finray/finger.obj"); }

TEST(Tetgen, ElementsFillTheSurfaceAndKeepItsPoints) {
  const TriangleMesh surface = finger();
  for (const int nodes : {4, 10}) {
    TetgenOptions options;
    options.nodes_per_element = nodes;
    const TetMesh mesh = tetrahedralize(surface, options, "finger");
    double volume = 0;
    for (const double v : element_volumes(mesh)) {
      ASSERT_GT(v, 0);
      volume += v;
    }
    EXPECT_NEAR(volume, enclosed_volume(surface), 1e-9 * volume);
    for (std::size_t i = 0; i < surface.points.size(); ++i) ASSERT_EQ(mesh.points[i], surface.points[i]);
    // the boundary is the given surface, each triangle once, in four pieces where the elements are quadratic
    EXPECT_EQ(mesh.surface.size(), surface.triangles.size() * (nodes == 10 ? 4 : 1));
    EXPECT_EQ(closed_surface_defect({mesh.points, mesh.surface}), std::nullopt);
  }
}

TEST(Tetgen, TheFingerHasAThousandNodesOrMore) {
  const TetMesh mesh = tetrahedralize(finger(), {}, "finger");
  EXPECT_GE(mesh.points.size(), 1000u);
  EXPECT_LE(mesh.points.size(), 3000u);  // what a step may cost
}

TEST(Tetgen, ASmallerVolumeBoundGivesMoreElements) {
  TetgenOptions fine;
  fine.max_volume = 5e-9;
  fine.keeps_surface = false;  // thin walls cannot be refined without new points on them
  const TetMesh mesh = tetrahedralize(finger(), fine, "finger");
  EXPECT_GT(mesh.n_elements(), 2 * tetrahedralize(finger(), {}, "finger").n_elements());
  for (const double v : element_volumes(mesh)) ASSERT_LE(v, 5e-9 * (1 + 1e-9));
}

TEST(Tetgen, TheSameInputGivesTheSameBits) {
  const TetMesh a = tetrahedralize(finger(), {}, "finger"), b = tetrahedralize(finger(), {}, "finger");
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.elements, b.elements);
}

TEST(Tetgen, LeavesNothingInTheTemporaryFolder) {
  const TestFolder folder;
  ASSERT_EQ(setenv("TMPDIR", folder.path.c_str(), 1), 0);
  tetrahedralize(finger(), {}, "finger");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
  unsetenv("TMPDIR");
}

TEST(Tetgen, MissingProgramIsNamedWithThePackage) {
  const std::string path = std::getenv("PATH");
  const TriangleMesh surface = finger();
  setenv("PATH", "/nowhere", 1);
  // options of no other test: what one made before would be kept
  expect_error<Failure>([&] { tetrahedralize(surface, {.max_volume = 0.123}, "finger"); },
                        {"`tetgen`", "apt-get install tetgen", "PATH"});
  setenv("PATH", path.c_str(), 1);
}

TEST(Tetgen, SurfaceThatMeetsItselfIsNamed) {
  // two overlapping boxes: closed and outward, but no boundary of one solid
  const TestFolder folder;
  const auto file =
      folder.write("crossed.obj",
                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0.1 0.1 -0.5\nv 1.1 0.1 -0.5\nv 0.1 1.1 -0.5\nv 0.1 0.1 0.5\n"
                   "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n");
  const TriangleMesh surface = read_closed_surface(file);
  expect_error<Failure>([&] { tetrahedralize(surface, {}, "crossed.obj"); },
                        {"crossed.obj", "tetgen cannot fill", "intersect"});
}

TEST(Tetgen, OpenSurfaceIsRefusedBeforeTheProgramIsCalled) {
  TriangleMesh surface = finger();
  surface.triangles.pop_back();
  expect_error<UsageError>([&] { tetrahedralize(surface, {}, "finger"); }, {"finger", "holes"});
}

}  // namespace
}  // namespace pvg
