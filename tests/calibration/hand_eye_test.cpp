// A wrist camera's mount from corners that a known camera on a known mount sees.
#include "host/calibration/hand_eye.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/base/error.hpp"
#include "tests/calibration/board_photos.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

Pose pose_of(const Vec3& position, double angle, const Vec3& axis) {
  Pose pose = Pose::Identity();
  pose.translation() = position;
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return pose;
}

// k1 k2 p1 p2 of OpenCV's model
Camera wrist_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 612.4;
  camera.fy = 610.9;
  camera.cx = 327.3;
  camera.cy = 233.8;
  camera.distortion = {-0.28, 0.09, 0.0008, -0.0005};
  return camera;
}

Eigen::Vector2d seen(const Camera& c, const Vec3& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double k1 = c.distortion[0], k2 = c.distortion[1], p1 = c.distortion[2], p2 = c.distortion[3];
  const double radial = 1 + k1 * r2 + k2 * r2 * r2;
  return {c.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + c.cx,
          c.fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + c.cy};
}

const Pose MOUNT = pose_of({0.062, -0.011, 0.035}, 0.5, {0.2, 1, -0.4});
const Pose TAGS = pose_of({0.45, 0.1, 0.02}, 0.3, {0, 0.1, 1});

std::vector<PlacedTag> six_tags() {
  std::vector<PlacedTag> tags;
  for (int id = 0; id < 6; ++id) {
    PlacedTag tag{id, 0.04, Pose::Identity()};
    tag.pose.translation() = Vec3(0.06 * (id % 3) - 0.06, 0.06 * (id / 3) - 0.03, 0);
    tags.push_back(tag);
  }
  return tags;
}

// The camera 0.35 m above the tags, tilted by up to `tilt` about two axes and turned about its own; corners with noise.
std::vector<HandPhoto> photos_of(int n, double tilt, double noise, std::uint32_t seed = 3) {
  const Camera camera = wrist_camera();
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, 1);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<HandPhoto> photos;
  for (int i = 0; i < n; ++i) {
    const Pose down = pose_of(Vec3::Zero(), M_PI, Vec3::UnitX());
    const Pose tilted = pose_of(Vec3::Zero(), tilt * any(random), {std::cos(1.1 * i), std::sin(1.1 * i), 0});
    const Pose rolled =
        pose_of({0.03 * any(random), 0.02 * any(random), -0.35 - 0.05 * any(random)}, 0.6 * any(random), Vec3::UnitZ());
    const Pose camera_in_tags = tilted * down * rolled;
    HandPhoto photo;
    photo.file = "photo " + std::to_string(i);
    photo.hand = TAGS * camera_in_tags * MOUNT.inverse();
    for (const PlacedTag& tag : six_tags()) {
      FoundTag found;
      found.id = tag.id;
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 corner(k == 1 || k == 2 ? 0.02 : -0.02, k >= 2 ? 0.02 : -0.02, 0);
        found.corners[k] = seen(camera, camera_in_tags.inverse() * (tag.pose * corner)) +
                           noise * Eigen::Vector2d(error(random), error(random));
      }
      photo.found.push_back(found);
    }
    photos.push_back(photo);
  }
  return photos;
}

double millimetres_off(const Pose& a, const Pose& b) { return 1e3 * (a.translation() - b.translation()).norm(); }
double degrees_off(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / M_PI;
}

TEST(HandEye, TheMountOfExactCornersIsExact) {
  const HandEye found = calibrate_hand_eye(photos_of(6, 0.5, 0), six_tags(), wrist_camera());
  EXPECT_LE(millimetres_off(found.mount, MOUNT), 1e-3);
  EXPECT_LE(degrees_off(found.mount, MOUNT), 1e-3);
  EXPECT_LE(millimetres_off(found.tags, TAGS), 1e-3);
  EXPECT_LE(found.residual, 1e-3);
}

TEST(HandEye, FifteenPhotosGiveAMillimetreAndATenthOfADegree) {
  const HandEye found = calibrate_hand_eye(photos_of(15, 0.5, 0.2), six_tags(), wrist_camera());
  EXPECT_LE(millimetres_off(found.mount, MOUNT), 1);
  EXPECT_LE(degrees_off(found.mount, MOUNT), 0.1);
  EXPECT_NEAR(found.residual, 0.2 * std::sqrt(2.0), 0.04);  // of two coordinates, each with a noise of 0.2 pixels
  EXPECT_LE(millimetres_off(found.mount, MOUNT), 3e3 * found.position_sigma.norm());
  EXPECT_GE(3 * millimetres_off(found.mount, MOUNT), 1e2 * found.position_sigma.norm());
  for (const HandPhoto& photo : found.photos) EXPECT_TRUE(photo.is_used) << photo.file;
}

TEST(HandEye, PhotosWhoseHandWasElsewhereAreNamedAndDoNoHarm) {
  std::vector<HandPhoto> photos = photos_of(12, 0.5, 0.1);
  photos[2].hand = photos[2].hand * pose_of({0.02, 0, 0}, 0, Vec3::UnitX());
  photos[5].hand = photos[6].hand;
  photos[9].hand = photos[9].hand * pose_of(Vec3::Zero(), 0.1, Vec3::UnitY());
  photos[11].found.clear();
  const HandEye found = calibrate_hand_eye(photos, six_tags(), wrist_camera());
  EXPECT_LE(millimetres_off(found.mount, MOUNT), 1);
  EXPECT_LE(degrees_off(found.mount, MOUNT), 0.1);
  for (std::size_t i = 0; i < photos.size(); ++i)
    EXPECT_EQ(found.photos[i].is_used, i != 2 && i != 5 && i != 9 && i != 11) << i << ": " << found.photos[i].residual;
  EXPECT_NE(found.photos[11].reason.find("none of the tags"), std::string::npos);
  EXPECT_NE(found.photos[2].reason.find("stands out"), std::string::npos);
}

// The whole way: a wrist camera with distortion, blur and noise is path traced over a grid of tags, its photos are
// searched for tags, and the mount comes back.
TEST(HandEye, TwelvePathTracedPhotosGiveAMillimetreAndATenthOfADegree) {
  const Board grid = parse_board("tags,4x3,50,40");
  Camera optics = real_camera();
  optics.focus_distance = 0.35;
  std::vector<Pose> cameras;  // in the frame of the tags
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.4 * i, tilt = 0.15 + 0.04 * i;
    const Vec3 from(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt));
    cameras.push_back(looking(Vec3(0.1, 0.075, 0) + 0.35 * from, {0.1, 0.075, 0}, 0.5 * (i % 3 - 1)));
  }
  const std::vector<Picture8> pictures = photos(board_scene(grid), optics, cameras, 8);
  std::vector<HandPhoto> seen;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    seen.push_back({"photo " + std::to_string(i), TAGS * cameras[i] * MOUNT.inverse(), find_tags_finely(pictures[i]), 0,
                    true, ""});
  std::vector<PlacedTag> tags;
  for (int id = 0; id < 12; ++id) {
    PlacedTag tag{id, 0.04, Pose::Identity()};
    tag.pose.translation() = Vec3(id % 4 * 0.05 + 0.02, (2 - id / 4) * 0.05 + 0.02, 0);
    tags.push_back(tag);
  }
  const HandEye found = calibrate_hand_eye(seen, tags, real_camera());
  std::printf("mount off by %.3f mm, %.4f degrees; residual %.3f pixels, sigma %.3f mm\n",
              millimetres_off(found.mount, MOUNT), degrees_off(found.mount, MOUNT), found.residual,
              1e3 * found.position_sigma.norm());
  EXPECT_LE(millimetres_off(found.mount, MOUNT), 1);
  EXPECT_LE(degrees_off(found.mount, MOUNT), 0.1);
  EXPECT_LE(found.residual, 0.3);
}

TEST(HandEye, WhatLeavesTheMountOpenIsRefused) {
  const auto run = [](std::vector<HandPhoto> photos) {
    calibrate_hand_eye(std::move(photos), six_tags(), wrist_camera());
  };
  expect_error<UsageError>([&] { run(photos_of(3, 0.5, 0.1)); }, {"3 of 3 photos", "four are the least"});
  // turned about the camera's axis alone
  expect_error<UsageError>([&] { run(photos_of(8, 0, 0.1)); }, {"one axis alone"});
  std::vector<HandPhoto> mixed = photos_of(9, 0.5, 0.1);  // rows in another order
  const std::vector<HandPhoto> others = photos_of(9, 0.5, 0.1, 8);
  for (std::size_t i = 0; i < mixed.size(); ++i) mixed[i].hand = others[(i + 4) % 9].hand;
  expect_error<UsageError>([&] { run(mixed); }, {"suits half of the photos", "photos' order"});
}

}  // namespace
}  // namespace pvg
