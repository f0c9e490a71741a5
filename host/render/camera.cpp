#include "host/render/camera.hpp"

#include <Eigen/SVD>
#include <cmath>

#include "host/base/error.hpp"

namespace pvg {

void check_camera(const Camera& camera) {
  const std::string where = "camera " + camera.name + ": ";
  if (camera.width < 1 || camera.height < 1 || camera.width > 16384 || camera.height > 16384)
    throw UsageError(where + "a picture of " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                     " pixels; 1 to 16384 each");
  if (!(camera.fx > 0 && camera.fy > 0) || !std::isfinite(camera.cx) || !std::isfinite(camera.cy))
    throw UsageError(where + "fx and fy must be positive, cx and cy finite [pixels]");
  if (!(camera.exposure > 0)) throw UsageError(where + "exposure must be positive");
  const std::size_t n = camera.distortion.size();
  if (n != 0 && n != 4 && n != 5 && n != 8)
    throw UsageError(where + "distortion has " + std::to_string(n) +
                     " numbers; none, or OpenCV's 4, 5 or 8: k1 k2 p1 p2 k3 k4 k5 k6");
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

PinholeCamera pinhole_camera(const Camera& camera, const Eigen::Matrix4d& to_world) {
  PinholeCamera c{};
  c.fx = float(camera.fx);
  c.fy = float(camera.fy);
  c.cx = float(camera.cx);
  c.cy = float(camera.cy);
  std::vector<double> k = camera.distortion;  // k1 k2 p1 p2 k3 k4 k5 k6
  k.resize(8, 0.0);
  const int radial[6] = {0, 1, 4, 5, 6, 7};
  for (int i = 0; i < 6; ++i) c.k[i] = float(k[radial[i]]);
  c.p[0] = float(k[2]);
  c.p[1] = float(k[3]);
  for (const double coefficient : k) c.is_distorted |= coefficient != 0;
  for (int i = 0; i < 12; ++i) c.to_world[i] = float(to_world(i / 4, i % 4));
  c.width = std::uint32_t(camera.width);
  c.height = std::uint32_t(camera.height);
  return c;
}

}  // namespace pvg
