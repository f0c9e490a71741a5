// How fast everything in a Scene moves at one instant.
#pragma once
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

struct BodyVelocity {
  Vec3 origin = Vec3::Zero();  // of the body frame's origin, world [m/s]
  Vec3 spin = Vec3::Zero();    // world [rad/s]
};

struct SceneVelocity {
  std::vector<BodyVelocity> rigid;       // [n_rigid_bodies]
  std::vector<std::vector<Vec3>> soft;   // [n_soft_bodies][n_nodes, m/s]
  std::vector<std::vector<Vec3>> cloth;  // [n_cloths][n_points, m/s]
};

}  // namespace pvg
