// Colours of points from photos, against means by hand.
#include "host/capture/colors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/capture/background.hpp"
#include "host/capture/exposure.hpp"
#include "host/formats/picture_files.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

// A camera at the origin that looks along z at a wall at 2 m, and a photo of one grey.
CaptureFrame frame_of(const TestFolder& folder, const std::string& name, std::uint8_t grey) {
  Camera camera;
  camera.width = 16, camera.height = 12;
  camera.fx = camera.fy = 15;
  camera.cx = 7.5, camera.cy = 5.5;
  const std::size_t n = 16 * 12;
  write_depth_picture(folder.path / (name + ".depth.png"), {16, 12, std::vector<float>(n, 2)}, 1e-3);
  write_picture(folder.path / (name + ".png"), {16, 12, std::vector<std::uint8_t>(3 * n, grey)});
  return {name, folder.path / (name + ".png"), folder.path / (name + ".depth.png"), nullptr, camera, camera};
}

// IEC 61966-2-1
double linear(int byte) { return std::pow((byte / 255.0 + 0.055) / 1.055, 2.4); }

// Four photos of grey g and one of something bright that passed by. The plain mean m is (4 g + b) / 5; the second pass
// weighs a photo of c by 1 / (1 + 3 ((c - m) / 0.1)^2), the same difference in three channels.
TEST(Colors, WhatPassedByLeavesHardlyATrace) {
  const TestFolder folder;
  std::vector<CaptureFrame> frames;
  for (int i = 0; i < 5; ++i) frames.push_back(frame_of(folder, "f" + std::to_string(i), i == 2 ? 240 : 128));
  const std::vector<DepthPicture> depths(5, {16, 12, std::vector<float>(16 * 12, 2)});
  const std::vector<Vec3f> gains(5, Vec3f::Ones());
  const std::vector<Vec3f> points = {{0, 0, 2}, {0.1f, 0, 2}, {0, 0.1f, 2}}, normals(3, Vec3f(0, 0, -1));
  Device device;
  const SurfaceColors found = color_surface(device, {frames, depths, gains}, points, normals, {{0, 1, 2}}, 0.03);
  const double grey = linear(128), bright = linear(240), mean = (4 * grey + bright) / 5;
  const auto weight = [&](double c) { return 1 / (1 + 3 * std::pow((c - mean) / 0.1, 2)); };
  const double expected = (4 * weight(grey) * grey + weight(bright) * bright) / (4 * weight(grey) + weight(bright));
  EXPECT_EQ(found.n_seen, 3u);
  for (const Vec3f& color : found.colors) EXPECT_NEAR(color.x(), expected, 1e-4);
  EXPECT_LT(expected - grey, 0.1 * (mean - grey));
}

// A byte of 250 or more may have been cut, so such a photo counts a twentieth: of g and b the plain mean of the first
// pass is (g + b / 20) / (1 + 1 / 20), and the second pass weighs both by their distance from it.
TEST(Colors, PhotosThatMayBeCutCountLittle) {
  const TestFolder folder;
  const std::vector<CaptureFrame> frames = {frame_of(folder, "a", 240), frame_of(folder, "b", 255)};
  const std::vector<DepthPicture> depths(2, {16, 12, std::vector<float>(16 * 12, 2)});
  const std::vector<Vec3f> gains(2, Vec3f::Ones()), points = {{0, 0, 2}, {0.1f, 0, 2}, {0, 0.1f, 2}},
                                                    normals(3, Vec3f(0, 0, -1));
  Device device;
  const SurfaceColors found = color_surface(device, {frames, depths, gains}, points, normals, {{0, 1, 2}}, 0.03);
  const double whole = linear(240), cut = linear(255), mean = (whole + 0.05 * cut) / 1.05;
  const auto weight = [&](double c) { return 1 / (1 + 3 * std::pow((c - mean) / 0.1, 2)); };
  const double wa = weight(whole), wb = 0.05 * weight(cut);
  for (const Vec3f& color : found.colors) EXPECT_NEAR(color.x(), (wa * whole + wb * cut) / (wa + wb), 1e-4);
}

// Points of colour c_p in photos of gains 1 / g_f; one sample in five is of something else. The gains are g_f over
// their geometric mean; a photo that shares no point with another keeps 1.
TEST(Exposure, GainsOfPhotosFollowFromTheirOverlapDespiteForeignSamples) {
  const std::vector<Vec3f> truth = {{0.5f, 0.6f, 0.4f}, {1.5f, 1, 1.2f}, {0.9f, 1.3f, 2}, {1, 1, 1}};
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0.1f, 0.4f);
  std::vector<ColorSample> samples;
  for (std::uint32_t p = 0; p < 200; ++p) {
    const Vec3f color(unit(random), unit(random), unit(random));
    for (std::uint32_t f = 0; f < 3; ++f) {
      const Vec3f seen = color.cwiseQuotient(truth[f]);
      samples.push_back({p, f, random() % 5 == 0 ? Vec3f(unit(random), 0.9f, 0.02f) : seen});
    }
  }
  for (std::uint32_t p = 200; p < 210; ++p) samples.push_back({p, 3, Vec3f(0.1f, 0.2f, 0.3f)});
  const std::vector<Vec3f> gains = exposure_gains(samples, 210, 4);
  for (int k = 0; k < 3; ++k) {
    const float mean = std::cbrt(truth[0][k] * truth[1][k] * truth[2][k]);
    for (std::size_t f = 0; f < 3; ++f) EXPECT_NEAR(gains[f][k], truth[f][k] / mean, 0.02 * double(gains[f][k]));
    EXPECT_EQ(gains[3][k], 1);
  }
}

// The inverse depth of a plane is linear over the picture, which the membrane continues: 1/z = 0.4 + 0.002 x.
TEST(Background, AHoleInAPlaneIsFilledByThePlane) {
  DepthPicture plane{80, 60, {}};
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) plane.depth.push_back(float(1 / (0.4 + 0.002 * x)));
  DepthPicture holed = plane;
  for (int y = 15; y < 45; ++y)
    for (int x = 20; x < 60; ++x) holed.depth[std::size_t(80 * y + x)] = 0;
  const DepthPicture filled = without_holes(holed, 0);
  for (std::size_t i = 0; i < plane.depth.size(); ++i) EXPECT_NEAR(filled.depth[i], plane.depth[i], 0.005) << i;
}

}  // namespace
}  // namespace pvg
