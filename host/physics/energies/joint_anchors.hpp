// The points at which joints hold two bodies together, and what they transmit there.
#pragma once
#include <vector>

#include "host/model/physical_scene.hpp"
#include "host/model/state.hpp"

namespace pvg {

// In the joint frame [m]: one for a spherical joint, two on the axis of a revolute one, four of a fixed one; none of a
// prismatic joint, which is held by directions and offsets. Springs of Joint::stiffness join their ends.
std::vector<Vec3> joint_anchors(const Joint& joint);

struct JointLoad {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // about the joint frame's origin [N m]
};

// What the child exerts on the parent through the anchors, along the axes of the joint frame on the child. A torque
// about the axis of a revolute joint is its drive's and its friction's, and no part of it.
JointLoad joint_load(const Joint& joint, const AffineMap& parent, const AffineMap& child);

}  // namespace pvg
