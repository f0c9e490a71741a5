// Motion elements: what the robot does, one after the other, each relative to an object of the scene.
#pragma once
#include <string>

#include "host/scene/scene.hpp"

namespace pvg {

struct MotionElement {
  // move: the tool goes to the target, which the others also do unless they are
  // close, open: the gripper's joints go to `gripper`; wait: nothing moves
  enum class Type { approach, close, lift, carry, lower, open, retreat, wait };
  Type type = Type::approach;
  std::string object = {};         // target is given in the frame this object has at the start; empty: the world's
  Pose target = Pose::Identity();  // of the tool frame: z along the fingers (down in a grasp), y from finger to finger
  double gripper = 0;              // position of the gripper's joints at the end, of close and open [m]
  double duration = 0;             // of close, open and wait; of the others: 0, as fast as the limits allow [s]
  double speed = 0.3;              // share of the velocity and acceleration limits, in (0, 1]
  bool is_straight = true;         // the tool's origin moves on a straight line
};

}  // namespace pvg
