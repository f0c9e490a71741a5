// A capture's place from corners that a distorted camera sees, whose pixels are computed by OpenCV's formula here.
#include "host/calibration/tag_frame.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/base/error.hpp"
#include "tests/calibration/board_photos.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

Eigen::Vector2d pixel_of(const Camera& camera, const Vec3& world, const Pose& camera_in_world) {
  const Vec3 p = camera_in_world.inverse() * world;
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double radial = 1 + camera.distortion[0] * r2 + camera.distortion[1] * r2 * r2;
  return {camera.fx * x * radial + camera.cx, camera.fy * y * radial + camera.cy};
}

struct Scan {
  std::vector<PlacedTag> tags;
  std::vector<TagPhoto> photos;
  Pose world_from_capture = Pose::Identity();
};

// two tags, one on the table and one upright, from six sides at 0.8 m, with noise of the corners [pixels]
Scan scan(double noise) {
  Scan out;
  out.tags = {{3, 0.08, Pose::Identity()}, {5, 0.05, Pose::Identity()}};
  out.tags[1].pose = Eigen::Translation3d(0.2, 0.1, 0.06) * Eigen::AngleAxisd(M_PI / 2, Vec3::UnitX());
  out.world_from_capture = Eigen::Translation3d(0.4, -1, 0.3) * Eigen::AngleAxisd(1.3, Vec3(1, 2, -1).normalized());
  std::mt19937 random(4);
  std::normal_distribution<double> gauss(0, 1);  // its sigma must not be 0
  for (int i = 0; i < 6; ++i) {
    TagPhoto photo{"photo", {}, {}};
    photo.camera.fx = photo.camera.fy = 600;
    photo.camera.cx = 320;
    photo.camera.cy = 240;
    photo.camera.distortion = {-0.2, 0.05, 0, 0};
    const double angle = -M_PI / 2 + 0.3 * (i - 2.5);
    const Pose place = looking({0.65 * std::cos(angle), 0.65 * std::sin(angle), 0.5}, {0.1, 0, 0}, 0.1 * i);
    for (const PlacedTag& tag : out.tags) {
      FoundTag found;
      found.id = tag.id;
      for (std::size_t k = 0; k < 4; ++k) {
        const double x = k == 1 || k == 2 ? 0.5 : -0.5, y = k >= 2 ? 0.5 : -0.5;
        found.corners[k] = pixel_of(photo.camera, tag.pose * Vec3(tag.size * x, tag.size * y, 0), place) +
                           noise * Eigen::Vector2d(gauss(random), gauss(random));
      }
      photo.found.push_back(found);
    }
    photo.camera.pose = out.world_from_capture.inverse() * place;
    out.photos.push_back(photo);
  }
  return out;
}

TEST(TagFrame, ACaptureStandsWhereItsTagsDo) {
  const Scan exact = scan(0);
  const TagFrame frame = locate_tags(exact.photos, exact.tags);
  EXPECT_LE((frame.world_from_capture.matrix() - exact.world_from_capture.matrix()).norm(), 1e-6);
  EXPECT_NEAR(frame.scale, 1, 1e-6);
  EXPECT_EQ(frame.used, (std::vector<int>{3, 5}));
  EXPECT_EQ(frame.n_photos, 6u);
}

// A pixel is 1.3 mm here; six photos and eight corners of 0.2 pixels leave a millimetre and half a degree by far.
TEST(TagFrame, NoiseOfCornersMovesItLittle) {
  const Scan noisy = scan(0.2);
  const TagFrame frame = locate_tags(noisy.photos, noisy.tags);
  const Pose off = frame.world_from_capture * noisy.world_from_capture.inverse();
  EXPECT_LE(off.translation().norm(), 1e-3);
  EXPECT_LE(Eigen::AngleAxisd(off.linear()).angle(), 0.5 * M_PI / 180);
  EXPECT_GT(frame.residual, 1e-5);
  EXPECT_LE(frame.residual, 1e-3);
}

TEST(TagFrame, WhatAUserCanGetWrongIsOneSentence) {
  Scan wrong = scan(0);
  for (PlacedTag& tag : wrong.tags) tag.size *= 1.2;
  wrong.tags.pop_back();
  expect_error<UsageError>([&] { locate_tags(wrong.photos, wrong.tags); }, {"0.833 times as large", "size"});
  wrong = scan(0);
  wrong.photos.resize(1);
  expect_error<UsageError>([&] { locate_tags(wrong.photos, wrong.tags); }, {"none of the 2 tags", "1 photo "});
}

}  // namespace
}  // namespace pvg
