// Where everything in a Scene is at one instant: what physics hands to rendering and recording.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

// x = A X + p as the 3 x 4 matrix [A | p]; A is a rotation up to the affine body's tiny strain
using AffineMap = Eigen::Matrix<double, 3, 4>;

struct SceneState {
  double time = 0;                       // [s]
  std::vector<AffineMap> rigid;          // [n_rigid_bodies] body to world
  std::vector<std::vector<Vec3>> soft;   // [n_soft_bodies][n_nodes] world positions [m]
  std::vector<std::vector<Vec3>> cloth;  // [n_cloths][n_points] world positions [m]
  std::vector<double> reading;           // [n_displays] of scales [kg]
};

}  // namespace pvg
