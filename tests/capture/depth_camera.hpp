// A small depth camera at a place that looks at another one.
#pragma once
#include <cmath>

#include "host/render/camera.hpp"

namespace pvg {

inline Camera camera_at(const Vec3& eye, const Vec3& at) {
  Camera camera;
  camera.name = "depth";
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 150;
  camera.cx = 79.5;
  camera.cy = 59.5;
  const Vec3 z = (at - eye).normalized(),
             x = z.cross(std::abs(z.z()) > 0.9 ? Vec3::UnitY() : Vec3::UnitZ()).normalized();
  camera.pose.linear().col(0) = x;
  camera.pose.linear().col(1) = z.cross(x);
  camera.pose.linear().col(2) = z;
  camera.pose.translation() = eye;
  return camera;
}

}  // namespace pvg
