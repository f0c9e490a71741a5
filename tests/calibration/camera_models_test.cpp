// Calibration from computed corners: of a fisheye, whose standard deviations must be those of repeated trials, and of a
// camera with a rolling shutter, which the model of the camera does not know.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "host/calibration/calibration.hpp"
#include "tests/calibration/board_photos.hpp"

namespace pvg {
namespace {

constexpr int N_PHOTOS = 12;

Pose pose_of_photo(int i) {
  const Vec3 middle(0.11, 0.08, 0);
  const double angle = 2.4 * i, tilt = 0.15 + 0.045 * i, distance = 0.22 + 0.015 * (i % 5);
  const Vec3 from(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt));
  const Vec3 aside(0.035 * std::cos(1.7 * i), 0.03 * std::sin(1.7 * i), 0);
  return looking(middle + distance * from, middle + aside, 0.2 * (i % 3 - 1));
}

// corners of a board of 10 x 7, by where the camera sees a point of the board in a photo
template <class Pixel>
std::vector<BoardPhoto> computed_photos(double sigma, std::mt19937& random, const Pixel& pixel) {
  std::normal_distribution<double> noise(0, 1);
  std::vector<BoardPhoto> photos;
  for (int i = 0; i < N_PHOTOS; ++i) {
    BoardPhoto photo{"photo " + std::to_string(i), {}, 0, true, "", {}};
    for (int k = 0; k < 70; ++k) {
      const Vec3 point(0.02 * (k % 10 + 1), 0.02 * (k / 10 + 1), 0);
      const Eigen::Vector2d at = pixel(i, point);
      photo.corners.push_back({k, point, at + sigma * Eigen::Vector2d(noise(random), noise(random))});
    }
    photos.push_back(photo);
  }
  return photos;
}

// theta_d = theta (1 + k1 theta^2 + k2 theta^4)
Eigen::Vector2d fisheye_pixel(const Camera& c, const Vec3& p) {
  const double r = std::hypot(p.x(), p.y()), theta = std::atan2(r, p.z()), t2 = theta * theta;
  const double bent = theta * (1 + c.distortion[0] * t2 + c.distortion[1] * t2 * t2) / r;
  return {c.fx * bent * p.x() + c.cx, c.fy * bent * p.y() + c.cy};
}

TEST(CalibrateCamera, StandardDeviationsOfAFisheyeAreTheSpreadOfRepeatedTrials) {
  constexpr int N_DRAWS = 30;
  constexpr double NOISE = 0.1;  // of each coordinate [pixels]
  Camera truth;
  truth.fx = truth.fy = 310;
  truth.cx = 322;
  truth.cy = 236;
  truth.distortion = {0.04, -0.01, 0, 0};
  CalibrationSettings settings;
  settings.model = Camera::Model::fisheye;
  std::mt19937 random(11);
  std::array<double, 8> mean = {}, square = {}, told = {};
  for (int draw = 0; draw < N_DRAWS; ++draw) {
    const auto photos = computed_photos(NOISE, random, [&](int i, const Vec3& point) {
      return fisheye_pixel(truth, pose_of_photo(i).inverse() * point);
    });
    const CameraCalibration c = calibrate_camera(photos, 640, 480, settings);
    ASSERT_EQ(c.sigma.size(), 8u);
    const double found[8] = {c.camera.fx,
                             c.camera.fy,
                             c.camera.cx,
                             c.camera.cy,
                             c.camera.distortion[0],
                             c.camera.distortion[1],
                             c.camera.distortion[2],
                             c.camera.distortion[3]};
    for (std::size_t k = 0; k < 8; ++k) {
      mean[k] += found[k] / N_DRAWS;
      square[k] += found[k] * found[k] / N_DRAWS;
      told[k] += c.sigma[k] / N_DRAWS;
    }
  }
  for (std::size_t k = 0; k < 8; ++k) {
    const double spread = std::sqrt((square[k] - mean[k] * mean[k]) * N_DRAWS / (N_DRAWS - 1));
    std::printf("parameter %zu: spread %.3g, told %.3g, ratio %.3f\n", k, spread, told[k], spread / told[k]);
    EXPECT_NEAR(spread / told[k], 1, 0.25) << k;
  }
}

// Rows are read one after the other while the camera moves, in another direction at each photo: the corners are where a
// camera stands at the time of their row.
TEST(CalibrateCamera, ARollingShutterInMotionIsToldByItsResidual) {
  const Camera truth = real_camera();
  constexpr double READOUT = 0.02, NOISE = 0.05;  // of all rows [s], of each coordinate [pixels]
  const auto pinhole = [&](const Vec3& p) {
    return Eigen::Vector2d(truth.fx * p.x() / p.z() + truth.cx, truth.fy * p.y() / p.z() + truth.cy);
  };
  const auto calibrated = [&](double speed) {
    std::mt19937 random(3);
    CalibrationSettings settings;
    settings.n_distortion = 4;
    return calibrate_camera(computed_photos(NOISE, random,
                                            [&](int i, const Vec3& point) {
                                              const Vec3 velocity =
                                                  speed * Vec3(std::cos(2.1 * i), std::sin(2.1 * i), 0);
                                              const Vec3 p = pose_of_photo(i).inverse() * point;
                                              Eigen::Vector2d at = pinhole(p);
                                              for (int round = 0; round < 5; ++round)
                                                at = pinhole(p - velocity * READOUT * (at.y() - 479) / 480);
                                              return at;
                                            }),
                            640, 480, settings);
  };
  double still = 0;
  for (const double speed : {0.0, 0.02, 0.05, 0.1}) {  // [m/s]
    const CameraCalibration c = calibrated(speed);
    std::printf("%.2f m/s: fx %.2f %% off (sigma %.2f %%), centre %.2f and %.2f pixels, residual %.3f pixels\n", speed,
                100 * (c.camera.fx / truth.fx - 1), 100 * c.sigma[0] / truth.fx, c.camera.cx - truth.cx,
                c.camera.cy - truth.cy, c.residual);
    if (speed == 0) {
      still = c.residual;
      EXPECT_NEAR(c.residual, NOISE * std::sqrt(2.0), 0.01);
      EXPECT_NEAR(c.camera.fx, truth.fx, 3 * c.sigma[0]);
    } else {
      EXPECT_GT(c.residual, 1.5 * still) << speed;
      EXPECT_NEAR(c.camera.fx, truth.fx, 0.02 * truth.fx) << speed;
    }
  }
}

}  // namespace
}  // namespace pvg
