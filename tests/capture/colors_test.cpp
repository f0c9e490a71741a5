// Colours of points from photos, against means by hand.
#include "host/capture/colors.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
  return {name, folder.path / (name + ".png"), folder.path / (name + ".depth.png"), camera, camera};
}

// IEC 61966-2-1
double linear(int byte) { return std::pow((byte / 255.0 + 0.055) / 1.055, 2.4); }

// Four photos of grey g and one of something white that passed by. The plain mean m is (4 g + 1) / 5; the second pass
// weighs a photo of c by 1 / (1 + 3 ((c - m) / 0.05)^2), the same difference in three channels.
TEST(Colors, WhatPassedByLeavesHardlyATrace) {
  const TestFolder folder;
  Capture capture;
  for (int i = 0; i < 5; ++i) capture.frames.push_back(frame_of(folder, "f" + std::to_string(i), i == 2 ? 255 : 128));
  const std::vector<Vec3f> points = {{0, 0, 2}, {0.1f, 0, 2}, {0, 0.1f, 2}}, normals(3, Vec3f(0, 0, -1));
  Device device;
  const SurfaceColors found = color_surface(device, capture, capture.frames, points, normals, {{0, 1, 2}}, 0.01);
  const double grey = linear(128), mean = (4 * grey + 1) / 5;
  const auto weight = [&](double c) { return 1 / (1 + 3 * std::pow((c - mean) / 0.05, 2)); };
  const double expected = (4 * weight(grey) * grey + weight(1)) / (4 * weight(grey) + weight(1));
  EXPECT_EQ(found.n_seen, 3u);
  for (const Vec3f& color : found.colors) EXPECT_NEAR(color.x(), expected, 1e-4);
  EXPECT_LT(expected - grey, 0.1 * (mean - grey));
}

}  // namespace
}  // namespace pvg
