// Bodies of revolution, whose volumes are known.
#include "host/capture/objects/lathe.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "host/base/error.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

TEST(Lathe, AConeHasAThirdOfItsCylinder) {
  const Profile outline = closed_outline({{0, 0}, {0.03, 0}, {0, 0.1}}, 0);
  for (const std::uint32_t sectors : {7u, 96u}) {
    const TriangleMesh cone = revolved(outline, sectors);
    EXPECT_EQ(closed_surface_defect(cone), std::nullopt);
    EXPECT_NEAR(enclosed_volume(cone) / (M_PI * 0.03 * 0.03 * 0.1 / 3), 1, 1e-12) << sectors;
  }
  // the same from the top down
  EXPECT_GT(enclosed_volume(revolved(closed_outline({{0, 0.1}, {0.03, 0}, {0, 0}}, 0), 7)), 0);
}

// A tumbler of 30 mm radius and 80 mm height with a wall and a floor of 3 mm, of glass.
TEST(Lathe, AVesselHasTheMassOfItsWall) {
  const Profile outline = closed_outline({{0, 0}, {0.03, 0}, {0.03, 0.08}}, 3e-3);
  ASSERT_EQ(outline.size(), 6u);
  EXPECT_NEAR((outline[3] - Eigen::Vector2d(0.027, 0.08)).norm(), 0, 1e-12);
  EXPECT_NEAR((outline[4] - Eigen::Vector2d(0.027, 0.003)).norm(), 0, 1e-12);
  ObjectSource source;
  source.name = "tumbler";
  source.mesh = revolved(outline, 32);
  EXPECT_TRUE(is_sound(source.mesh));
  ObjectSettings settings;
  settings.density = 2500;
  settings.error = 0.3e-3;
  settings.triangles = 200;
  const CapturedObject glass = capture_object(source, settings);
  EXPECT_TRUE(glass.was_sound);
  EXPECT_NEAR(glass.mass.mass / (2500 * M_PI * (0.03 * 0.03 * 0.08 - 0.027 * 0.027 * 0.077)), 1, 1e-9);
  EXPECT_TRUE(is_sound(glass.simulation));
  EXPECT_LE(glass.to_source.back(), 0.3e-3);
  EXPECT_LT(glass.simulation.triangles.size(), source.mesh.triangles.size());
}

TEST(Lathe, WhatIsNoOutlineIsRefused) {
  expect_error<UsageError>([] { closed_outline({{0, 0}, {0.03, 0}, {0.03, 0.08}}, 0); }, {"rim", "--wall"});
  expect_error<UsageError>([] { closed_outline({{0, 0}, {0.03, 0}, {0, 0.1}}, 1e-3); }, {"whole outline", "--wall"});
  expect_error<UsageError>([] { closed_outline({{0, 0}, {0.03, 0}, {0.03, 0.08}}, 0.031); }, {"too thick"});
  expect_error<UsageError>(
      [] {
        closed_outline({{0, 0}, {0.03, 0}, {0.03, 0.1}, {0.01, 0.1}, {0.04, 0.05}, {0, 0.12}}, 0);
      },
      {"crosses itself"});
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "pvg_lathe_profile.csv";
  const auto read = [&](const char* rows) {
    std::ofstream(file) << rows;
    return read_profile(file, 1e-3);
  };
  EXPECT_EQ(read("radius,height\n0,0\n30,0\n30,80\n")[2], Eigen::Vector2d(0.03, 0.08));
  expect_error<UsageError>([&] { read("radius,height\n1,0\n30,0\n30,80\n"); }, {"row 1", "axis"});
  expect_error<UsageError>([&] { read("radius,height\n0,0\n-30,0\n30,80\n"); }, {"row 2", "negative"});
  expect_error<UsageError>([&] { read("radius,height\n0,0\n0,1\n30,80\n"); }, {"row 2", "axis"});
  expect_error<UsageError>([&] { read("radius,height\n0,0\n30,0\n"); }, {"three rows"});
  expect_error<UsageError>([&] { read("r,height\n0,0\n30,0\n30,80\n"); }, {"`radius` is missing"});
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace pvg
