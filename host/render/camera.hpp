// A Camera of the scene as the device's, and its pose in the world.
#pragma once
#include "host/model/scene.hpp"
#include "host/model/state.hpp"
#include "render/path.h"

namespace pvg {

// Refuses what no camera can have, naming it.
void check_camera(const Camera& camera);

// camera to world; the axes of a body's map are made orthonormal, since an affine body may be strained a little
Eigen::Matrix4d camera_to_world(const Camera& camera, const SceneState& state);

// Its distortion with k1 added to its first radial coefficient, that of r^2 (of a fisheye theta^2).
std::vector<double> distortion_with(const Camera& camera, double k1);

PinholeCamera pinhole_camera(const Camera& camera, const Eigen::Matrix4d& to_world);

}  // namespace pvg
