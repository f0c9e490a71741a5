// Boards and cameras against path-traced photos, whose truth is known.
#include "host/calibration/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "host/base/error.hpp"
#include "host/formats/picture_files.hpp"
#include "tests/calibration/board_photos.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

const Board BOARD = parse_board("charuco,11x8,20,15");

TEST(Board, TheTextOfABoardIsReadBack) {
  for (const char* text : {"charuco,7x5,30,22", "chessboard,9x6,24.5", "tags,6x4,40,30"})
    EXPECT_EQ(name_of(parse_board(text)), text);
  expect_error<UsageError>([] { parse_board("charuco,7x5,30"); }, {"charuco,7x5,30", "tag smaller"});
  expect_error<UsageError>([] { parse_board("circles,7x5,30,22"); }, {"circles", "charuco, chessboard or tags"});
  expect_error<UsageError>([] { parse_board("tags,40x40,30,22"); }, {"587"});
}

constexpr double RESOLUTION = 5000;  // [pixels per m]
constexpr int MARGIN = 150;          // white around the board [pixels]

Picture8 printed(const Board& board, bool is_mirrored) {
  const Texture print = board_picture(board, RESOLUTION);
  Picture8 photo{print.width + 2 * MARGIN, print.height + 2 * MARGIN, {}};
  photo.rgb.assign(std::size_t(photo.width) * std::size_t(photo.height) * 3, 255);
  for (int y = 0; y < print.height; ++y)
    for (int x = 0; x < print.width; ++x)
      for (int k = 0; k < 3; ++k)
        photo.rgb[std::size_t(((y + MARGIN) * photo.width + x + MARGIN) * 3 + k)] =
            print.rgba[std::size_t((y * print.width + (is_mirrored ? print.width - 1 - x : x)) * 4 + k)];
  return photo;
}

// Printed at 5 pixels per millimetre and looked at straight on, every corner is where the board says.
TEST(Board, EveryCornerOfAPrintedBoardIsFoundWhereItIs) {
  for (const char* text : {"charuco,7x5,30,22", "chessboard,7x6,30", "tags,4x3,40,30"}) {
    const Board board = parse_board(text);
    const Picture8 photo = printed(board, false);
    const std::vector<BoardCorner> corners = find_board(photo, board);
    const bool is_grid = board.kind == Board::Kind::tags;
    EXPECT_EQ(corners.size(), std::size_t(is_grid ? 4 * 12 : (board.columns - 1) * (board.rows - 1))) << text;
    for (const BoardCorner& c : corners) {
      // an edge of the print lies between two pixels
      EXPECT_NEAR(c.pixel.x(), MARGIN + c.point.x() * RESOLUTION - 0.5, is_grid ? 0.3 : 0.1) << text;
      EXPECT_NEAR(c.pixel.y(), photo.height - MARGIN - c.point.y() * RESOLUTION - 0.5, is_grid ? 0.3 : 0.1) << text;
    }
  }
}

TEST(Board, AMirroredBoardIsFoundAsSuch) {
  for (const char* text : {"charuco,7x5,30,22", "tags,4x3,40,30"}) {
    const Board board = parse_board(text);
    const std::size_t all = board.kind == Board::Kind::tags ? 4 * 12 : 6 * 4;
    EXPECT_LT(find_board(printed(board, true), board).size(), CalibrationSettings().fewest_corners) << text;
    EXPECT_EQ(find_mirrored_board(printed(board, true), board).size(), all) << text;
    EXPECT_LT(find_mirrored_board(printed(board, false), board).size(), CalibrationSettings().fewest_corners) << text;
  }
}

// The library's pixels count from the corner of the first one.
TEST(Tags, AreWhereTheTagLibrarySays) {
  const fs::path folder = fs::path(PVG_SHARED_FOLDER) / "realdata/apriltag_photos";
  if (!fs::exists(folder)) GTEST_SKIP() << "the photos of AprilRobotics/apriltag are not here";
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".txt") continue;
    std::vector<std::array<double, 8>> truth;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);) {
      std::array<double, 8> t;
      int id = 0;
      if (std::sscanf(line.c_str(), "%d, (%lf %lf), (%lf %lf), (%lf %lf), (%lf %lf)", &id, &t[0], &t[1], &t[2], &t[3],
                      &t[4], &t[5], &t[6], &t[7]) == 9)
        truth.push_back(t);
    }
    const std::vector<FoundTag> found = find_tags(read_picture(fs::path(entry.path()).replace_extension(".jpg")));
    EXPECT_EQ(found.size(), truth.size()) << entry.path();
    for (const auto& t : truth) {
      double best = INFINITY;
      for (const FoundTag& tag : found) {
        double worst = 0;
        for (std::size_t k = 0; k < 4; ++k)
          worst =
              std::max(worst, std::hypot(tag.corners[k].x() + 0.5 - t[2 * k], tag.corners[k].y() + 0.5 - t[2 * k + 1]));
        best = std::min(best, worst);
      }
      EXPECT_LE(best, 0.5) << entry.path() << " at " << t[0] << ", " << t[1];
    }
  }
}

TEST(CalibrateCamera, FifteenPathTracedPhotosGiveTheCameraBack) {
  const Camera truth = real_camera();
  const CameraCalibration c = calibration_from(photos(board_scene(BOARD), truth, poses_around_board(15), 8), BOARD);
  std::printf(
      "fx %.3f (%.3f +- %.3f) fy %.3f (%.3f) cx %.3f (%.3f +- %.3f) cy %.3f (%.3f) k1 %.4f +- %.4f k2 %.4f +- %.4f, "
      "%.3f px\n",
      c.camera.fx, truth.fx, c.sigma[0], c.camera.fy, truth.fy, c.camera.cx, truth.cx, c.sigma[2], c.camera.cy,
      truth.cy, c.camera.distortion[0], c.sigma[4], c.camera.distortion[1], c.sigma[5], c.residual);
  EXPECT_NEAR(c.camera.fx, truth.fx, 1e-3 * truth.fx);
  EXPECT_NEAR(c.camera.fy, truth.fy, 1e-3 * truth.fy);
  EXPECT_NEAR(c.camera.cx, truth.cx, 0.5);
  EXPECT_NEAR(c.camera.cy, truth.cy, 0.5);
  EXPECT_NEAR(c.camera.distortion[0], truth.distortion[0], 2 * c.sigma[4]);
  EXPECT_NEAR(c.camera.distortion[1], truth.distortion[1], 2 * c.sigma[5]);
  EXPECT_LE(c.residual, 0.2);
}

TEST(CalibrateCamera, APhotoOfABentBoardIsNamed) {
  const Camera truth = real_camera();
  std::vector<BoardPhoto> seen;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.05);
  const std::vector<Pose> poses = poses_around_board(15);
  for (std::size_t i = 0; i < 8; ++i) {  // corners as a camera without distortion sees them
    BoardPhoto photo{"photo " + std::to_string(i), {}, 0, true, "", {}};
    for (int k = 0; k < 70; ++k) {
      const Vec3 point(0.02 * (k % 10 + 1), 0.02 * (k / 10 + 1), 0), p = poses[i].inverse() * point;
      photo.corners.push_back(
          {k,
           point,
           {truth.fx * p.x() / p.z() + truth.cx + noise(random), truth.fy * p.y() / p.z() + truth.cy + noise(random)}});
    }
    seen.push_back(photo);
  }
  for (BoardCorner& corner : seen[3].corners) corner.pixel += Eigen::Vector2d(3 * std::sin(40 * corner.point.x()), 0);
  const CameraCalibration c = calibrate_camera(seen, truth.width, truth.height, {});
  for (std::size_t i = 0; i < c.photos.size(); ++i) EXPECT_EQ(c.photos[i].is_used, i != 3) << i;
  EXPECT_TRUE(c.photos[3].differences.empty());
  double sum = 0;
  for (const BoardPhoto& photo : c.photos)
    for (const Eigen::Vector2d& d : photo.differences) sum += d.squaredNorm();
  EXPECT_NEAR(c.residual, std::sqrt(sum / (7 * 70)), 1e-9);
  EXPECT_NEAR(c.residual, 0.05 * std::sqrt(2.0), 0.01);  // the noise of both coordinates
  seen.resize(1);
  expect_error<UsageError>([&] { calibrate_camera(seen, truth.width, truth.height, {}); }, {"1 of 1", "three"});
}

TEST(CalibrateCamera, ItsPlaceIsFoundFromTagsWithinAMillimetreAtOneMetre) {
  const Board grid = parse_board("tags,4x3,80,64");
  const Camera truth = real_camera();
  Camera optics = truth;
  optics.focus_distance = 1;
  const Pose pose = looking({0.5, -0.35, 0.82}, {0.15, 0.11, 0}, 0.1);
  const std::vector<FoundTag> found = find_tags_finely(photos(board_scene(grid), optics, {pose}, 16)[0]);
  ASSERT_EQ(found.size(), 12u);
  std::vector<PlacedTag> tags;
  for (int id = 0; id < 12; ++id) {
    PlacedTag tag{id, 0.064, Pose::Identity()};
    tag.pose.translation() = Vec3(id % 4 * 0.08 + 0.032, (2 - id / 4) * 0.08 + 0.032, 0);
    tags.push_back(tag);
  }
  const CameraPlace place = place_camera(found, tags, truth);
  std::printf("off by %.3f mm, residual %.3f pixels, sigma %.3f mm\n",
              1e3 * (place.pose.translation() - pose.translation()).norm(), place.residual,
              1e3 * place.position_sigma.norm());
  EXPECT_LE((place.pose.translation() - pose.translation()).norm(), 1e-3);
  EXPECT_LE(Eigen::AngleAxisd(place.pose.linear().transpose() * pose.linear()).angle(), 0.1 * M_PI / 180);
  expect_error<UsageError>([&] { place_camera({}, tags, truth); }, {"none of the 12 tags"});
}

}  // namespace
}  // namespace pvg
