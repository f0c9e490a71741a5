#include "host/robot/multibody.hpp"

#include <algorithm>

namespace pvg {

double start_within(const Joint& joint, double rest) {
  return joint.lower < joint.upper ? std::clamp(rest, joint.lower, joint.upper) : rest;
}

Pose start_of_child(const Joint& joint) {
  Pose motion = Pose::Identity();
  if (joint.type == Joint::Type::revolute)
    motion.linear() = Eigen::AngleAxisd(joint.initial, joint.axis).toRotationMatrix();
  if (joint.type == Joint::Type::prismatic) motion.translation() = joint.initial * joint.axis;
  return joint.parent_frame * motion * joint.child_frame.inverse();
}

}  // namespace pvg
