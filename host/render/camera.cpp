#include "host/render/camera.hpp"

#include <Eigen/SVD>
#include <array>
#include <cmath>

#include "host/base/error.hpp"

namespace pvg {

void check_camera(const Camera& camera) {
  const std::string where = "camera " + camera.name + ": ";
  if (camera.width < 1 || camera.height < 1 || camera.width > 16384 || camera.height > 16384)
    throw UsageError(where + "a picture of " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                     " pixels; 1 to 16384 each");
  const auto is_focal = [](double f) { return f > 1e-3 && f < 1e7; };
  if (!is_focal(camera.fx) || !is_focal(camera.fy))
    throw UsageError(where + "fx and fy must be between 0.001 and 10 million pixels");
  if (!(std::abs(camera.cx) <= 10.0 * camera.width) || !(std::abs(camera.cy) <= 10.0 * camera.height))
    throw UsageError(where + "cx and cy must be pixels at or near the picture, which has " +
                     std::to_string(camera.width) + " x " + std::to_string(camera.height));
  if (!(camera.exposure > 0)) throw UsageError(where + "exposure must be positive");
  const bool is_fisheye = camera.model == Camera::Model::fisheye;
  const std::size_t n = camera.distortion.size();
  if (is_fisheye ? n != 0 && n != 4 : n != 0 && n != 4 && n != 5 && n != 8)
    throw UsageError(where + "distortion has " + std::to_string(n) +
                     (is_fisheye ? " numbers; none, or OpenCV's 4: k1 k2 k3 k4"
                                 : " numbers; none, or OpenCV's 4, 5 or 8: k1 k2 p1 p2 k3 k4 k5 k6"));
  for (const double k : camera.distortion)
    if (!(std::abs(k) < 1e6)) throw UsageError(where + "its distortion is not finite or absurdly large");
  if (!(camera.lens_radius >= 0 && camera.lens_radius <= 1))
    throw UsageError(where + "the lens radius must be 0 to 1 m");
  if (!(camera.focus_distance > 0)) throw UsageError(where + "focus_distance must be positive [m]");
  if (is_fisheye && camera.lens_radius > 0) throw UsageError(where + "a fisheye has no lens radius: all is sharp");
  if (!(camera.exposure_time >= 0 && camera.row_time >= 0)) throw UsageError(where + "times must not be negative [s]");
  if (camera.vignetting.size() > 3) throw UsageError(where + "vignetting has more than the three numbers v1 v2 v3");
  if (!(camera.full_well >= 0 && camera.read_noise >= 0) || (camera.read_noise > 0 && camera.full_well == 0))
    throw UsageError(where + "noise needs a positive full_well [electrons], and read_noise of 0 or more");
}

Eigen::Matrix4d camera_to_world(const Camera& camera, const SceneState& state) {
  Eigen::Matrix4d pose = camera.pose.matrix();
  if (camera.rigid >= 0) {
    Eigen::Matrix4d body = Eigen::Matrix4d::Identity();
    body.topRows<3>() = state.rigid[camera.rigid];
    const Eigen::JacobiSVD<Mat3> svd(state.rigid[camera.rigid].leftCols<3>(),
                                     Eigen::ComputeFullU | Eigen::ComputeFullV);
    body.topLeftCorner<3, 3>() = svd.matrixU() * svd.matrixV().transpose();
    pose = body * pose;
  }
  return pose;
}

std::vector<double> distortion_with(const Camera& camera, double k1) {
  std::vector<double> distortion = camera.distortion;
  if (distortion.empty()) distortion.resize(4, 0.0);
  distortion[0] += k1;
  return distortion;
}

PinholeCamera pinhole_camera(const Camera& camera, const Eigen::Matrix4d& to_world) {
  PinholeCamera c{};
  c.fx = float(camera.fx);
  c.fy = float(camera.fy);
  c.cx = float(camera.cx);
  c.cy = float(camera.cy);
  std::vector<double> k = camera.distortion;  // k1 k2 p1 p2 k3 k4 k5 k6
  k.resize(8, 0.0);
  c.model = camera.model == Camera::Model::fisheye ? CAMERA_FISHEYE : CAMERA_PINHOLE;
  const std::array<int, 6> radial =
      c.model == CAMERA_FISHEYE ? std::array{0, 1, 2, 3, 6, 7} : std::array{0, 1, 4, 5, 6, 7};
  for (std::size_t i = 0; i < 6; ++i) c.k[i] = float(k[std::size_t(radial[i])]);
  if (c.model == CAMERA_PINHOLE) {
    c.p[0] = float(k[2]);
    c.p[1] = float(k[3]);
  }
  c.lens_radius = float(camera.lens_radius);
  c.focus_distance = float(camera.focus_distance);
  for (const double coefficient : k) c.is_distorted |= coefficient != 0;
  for (int i = 0; i < 12; ++i) c.to_world[i] = float(to_world(i / 4, i % 4));
  c.width = std::uint32_t(camera.width);
  c.height = std::uint32_t(camera.height);
  return c;
}

}  // namespace pvg
