// Gaussian splats: depth by hand, and files that hold what they should not.
#include "host/capture/objects/splats.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

// flat splats facing z, 2 cm apart, in a square wall at depth z
void add_wall(Splats& splats, float z, float opacity) {
  for (int y = -15; y <= 15; ++y)
    for (int x = -15; x <= 15; ++x) {
      Splat s{};
      s.center[0] = 0.02f * float(x);
      s.center[1] = 0.02f * float(y);
      s.center[2] = z;
      s.opacity = opacity;
      s.whiten[0] = s.whiten[4] = 1 / 0.01f;
      s.whiten[8] = 1 / 1e-4f;
      s.radius = 0.03f;
      splats.splats.push_back(s);
      splats.colors.push_back(Vec3f::Ones());
    }
}

Camera small_camera() {
  Camera camera;
  camera.width = 32, camera.height = 24;
  camera.fx = camera.fy = 60;
  camera.cx = 15.5, camera.cy = 11.5;
  return camera;
}

// A ray at a splat's middle meets alpha = opacity and some of its neighbours: 0.1 passes the first wall's share of 0.1
// and never half, and the second wall absorbs the rest.
TEST(Splats, TheMedianSeesThroughGlassAndTheFirstSurfaceDoesNot) {
  Splats splats;
  add_wall(splats, 1, 0.12f);
  add_wall(splats, 1.5f, 0.95f);
  Device device;
  const Camera camera = small_camera();
  const DepthPicture median = splat_depth(device, splats, camera, 0.5f),
                     first = splat_depth(device, splats, camera, 0.1f);
  const std::size_t middle = std::size_t(12 * 32 + 16);
  EXPECT_NEAR(median.depth[middle], 1.5, 1e-4);
  EXPECT_NEAR(first.depth[middle], 1, 1e-4);
}

// A wall tilted about y: z = 1 + 0.5 x. The ray of pixel u has x = z (u - cx) / fx, so z = 1 / (1 - 0.5 (u - cx) / fx).
TEST(Splats, TheDepthOfFlatSplatsIsThatOfTheirPlane) {
  Splats splats;
  add_wall(splats, 0, 0.95f);
  const Eigen::Vector3f normal = Vec3f(-0.5f, 0, 1).normalized(), along = Vec3f(1, 0, 0.5f).normalized();
  for (Splat& s : splats.splats) {
    const Vec3f at = Vec3f(0, 0, 1) + s.center[0] * along + s.center[1] * Vec3f::UnitY();
    for (int k = 0; k < 3; ++k) {
      s.center[k] = at[k];
      s.whiten[k] = along[k] / 0.01f;
      s.whiten[3 + k] = Vec3f::UnitY()[k] / 0.01f;
      s.whiten[6 + k] = normal[k] / 1e-4f;
    }
  }
  Device device;
  const Camera camera = small_camera();
  const DepthPicture seen = splat_depth(device, splats, camera, 0.5f);
  for (int u = 8; u < 24; ++u)
    EXPECT_NEAR(seen.depth[std::size_t(12 * 32 + u)], 1 / (1 - 0.5 * (u - 15.5) / 60), 2e-4) << u;
}

std::string header(const std::string& properties, int n) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(n) + "\n";
  for (std::size_t at = 0; at < properties.size();) {
    const std::size_t end = properties.find(' ', at);
    text += "property float " + properties.substr(at, end - at) + "\n";
    at = end == std::string::npos ? properties.size() : end + 1;
  }
  return text + "end_header\n";
}

const std::string NAMES = "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 rot_0 rot_1 rot_2 rot_3";

// opacity is the logistic function of 0, the colour 0.5 in sRGB, the scales e^-3 and e^-4 times 2
TEST(Splats, AFileIsReadAsItsFormatSays) {
  const TestFolder folder;
  folder.write("flat.ply", header(NAMES, 1) + "0.1 0.2 0.3 0 0 0 0 -3 -4 2 0 0 0\n");
  ASSERT_TRUE(is_splat_file(folder.path / "flat.ply"));
  const Splats splats = read_splats(folder.path / "flat.ply", 2);
  EXPECT_EQ(splats.format, "2DGS");
  ASSERT_EQ(splats.splats.size(), 1u);
  const Splat& s = splats.splats[0];
  EXPECT_FLOAT_EQ(s.center[2], 0.6f);
  EXPECT_FLOAT_EQ(s.opacity, 0.5f);
  EXPECT_NEAR(s.whiten[0], std::exp(3.0) / 2, 1e-4);
  EXPECT_NEAR(s.whiten[4], std::exp(4.0) / 2, 1e-4);
  EXPECT_NEAR(splats.colors[0].x(), 0.2140, 1e-4);  // IEC 61966-2-1 of 0.5
}

TEST(Splats, BrokenFilesAreNamedInOneSentence) {
  const TestFolder folder;
  const auto refused = [&](const std::string& text, std::initializer_list<const char*> words) {
    folder.write("splats.ply", text);
    expect_error<UsageError>([&] { read_splats(folder.path / "splats.ply", 1); }, words);
  };
  const std::string row = "0 0 0 0 0 0 0 -3 -4 1 0 0 0\n";
  refused(header(NAMES, 2) + row + "0 nan 0 0 0 0 0 -3 -4 1 0 0 0\n", {"splats.ply", "`y` of splat 1", "not a finite"});
  refused(
      header("x y z f_dc_0 f_dc_1 f_dc_2 scale_0 scale_1 rot_0 rot_1 rot_2 rot_3", 1) + "0 0 0 0 0 0 -3 -4 1 0 0 0\n",
      {"splats.ply", "no property `opacity`"});
  refused(header(NAMES, 1) + "0 0 0 0 0 0 0 -3 -4 0 0 0 0\n", {"splats.ply", "quaternion of splat 0"});
  refused(header(NAMES, 3) + row, {"splats.ply", "cut off"});
  refused(header(NAMES, 2000000000) + row, {"splats.ply", "cut off"});
  refused("plane\n", {"splats.ply", "no PLY"});
  refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n", {"splats.ply", "`list`"});
}

}  // namespace
}  // namespace pvg
