// What an arm must not run into.
#pragma once
#include <string>

#include "host/model/scene.hpp"

namespace pvg {

// A rigid thing: of the world, or carried by a link (the gripper).
struct Obstacle {
  std::string name;
  TriangleMesh mesh;             // [m]
  Pose pose = Pose::Identity();  // to the robot's base frame, or to the link that carries it
};

}  // namespace pvg
