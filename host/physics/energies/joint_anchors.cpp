#include "host/physics/energies/joint_anchors.hpp"

namespace pvg {
namespace {

constexpr double ANCHOR_LEVER = 0.1;  // distance of the anchors from the joint's centre [m]

}  // namespace

std::vector<Vec3> joint_anchors(const Joint& joint) {
  std::vector<Vec3> anchors;
  switch (joint.type) {
    case Joint::Type::spherical:
      anchors.push_back(Vec3::Zero());
      break;
    case Joint::Type::revolute:
      for (const double side : {-1.0, 1.0}) anchors.push_back(side * ANCHOR_LEVER * joint.axis.normalized());
      break;
    case Joint::Type::fixed:
      for (const Vec3& corner : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)})
        anchors.push_back(ANCHOR_LEVER * corner.normalized());
      break;
    case Joint::Type::prismatic:
      break;
  }
  return anchors;
}

JointLoad joint_load(const Joint& joint, const AffineMap& parent, const AffineMap& child) {
  const auto at = [](const AffineMap& map, const Vec3& x) -> Vec3 { return map.leftCols<3>() * x + map.col(3); };
  const Mat3 turn = child.leftCols<3>() * joint.child_frame.linear();
  JointLoad load;
  for (const Vec3& anchor : joint_anchors(joint)) {
    const Vec3 apart = at(child, joint.child_frame * anchor) - at(parent, joint.parent_frame * anchor);
    const Vec3 force = joint.stiffness * (turn.transpose() * apart);
    load.force += force;
    load.torque += anchor.cross(force);
  }
  return load;
}

}  // namespace pvg
