// Path-traced photos of a board that moves before a camera with a rolling shutter, which the camera's model does not
// know. camera_models_test.cpp has the same of computed corners.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/calibration/board_photos.hpp"

namespace pvg {
namespace {

constexpr double READOUT = 0.02;  // of all rows [s]

// real_camera() with pictures of another size, and a shutter that rolls
Camera rolling_camera(double share) {
  Camera camera = real_camera();
  camera.width = int(camera.width * share);
  camera.height = int(camera.height * share);
  camera.fx *= share;
  camera.fy *= share;
  camera.cx = (camera.cx + 0.5) * share - 0.5;
  camera.cy = (camera.cy + 0.5) * share - 0.5;
  camera.row_time = READOUT / camera.height;
  return camera;
}

// of n photos; the board goes at this speed [m/s] across the picture, in another direction at each photo
CameraCalibration calibrated(const Camera& truth, int n, double speed, int samples) {
  const Board board = parse_board("charuco,11x8,20,15");
  std::vector<Vec3> velocity;
  for (int i = 0; i < n; ++i) velocity.push_back(speed * Vec3(std::cos(2.1 * i), std::sin(2.1 * i), 0));
  const CameraCalibration c =
      calibration_from(photos_in_motion(board_scene(board), truth, poses_around_board(n), velocity, samples), board);
  std::printf(
      "%.2f m/s: fx %.2f %% off (sigma %.2f %%), centre %.2f and %.2f pixels (%.2f), k1 %.3f off (%.3f), residual %.3f "
      "pixels\n",
      speed, 100 * (c.camera.fx / truth.fx - 1), 100 * c.sigma[0] / truth.fx, c.camera.cx - truth.cx,
      c.camera.cy - truth.cy, c.sigma[2], c.camera.distortion[0] - truth.distortion[0], c.sigma[4], c.residual);
  std::fflush(stdout);
  return c;
}

TEST(CalibrateCamera, PathTracedPhotosWithARollingShutterAreToldByTheirResidual) {
  const Camera truth = rolling_camera(0.5);
  const CameraCalibration still = calibrated(truth, 6, 0, 4), moving = calibrated(truth, 6, 0.3, 4);
  EXPECT_NEAR(still.camera.fx, truth.fx, 3 * still.sigma[0]);
  EXPECT_GT(moving.residual, 1.5 * still.residual);
}

// for docs/measured
TEST(CalibrateCamera, DISABLED_MovingBoardsAtSeveralSpeeds) {
  for (const double speed : {0.0, 0.02, 0.05, 0.1}) calibrated(rolling_camera(1), 15, speed, 8);
}

}  // namespace
}  // namespace pvg
