// Motion elements: what the robots do, one after the other, each relative to an object of the scene.
#pragma once
#include <string>
#include <vector>

#include "host/model/scene.hpp"

namespace pvg {

struct MotionElement {
  // follow_arc, follow_path: the tool's way is given; close, open: the gripper's joints go to `gripper`; wait: nothing
  // moves. The others all take the tool to the target; their names say what for.
  enum class Type { approach, close, lift, carry, lower, open, retreat, wait, move, follow_arc, follow_path };
  Type type = Type::approach;
  int robot = 0;                   // of the task's robots
  bool is_with_previous = false;   // begins and ends together with the element before it
  std::string object = {};         // what is given is in the frame this object has at the start; empty: the world's
  bool is_in_tool_frame = false;   // it is in the frame that the tool has when the element begins instead
  Pose target = Pose::Identity();  // of the tool frame: z along the fingers (down in a grasp), y from finger to finger
  std::vector<Pose> path = {};     // of follow_path: what the tool passes through, on a smooth curve
  Vec3 center = Vec3::Zero();      // of follow_arc: a point of the axis [m]
  Vec3 axis = Vec3::UnitZ();       // of follow_arc, unit
  double angle = 0;                // of follow_arc [rad]
  bool turns_with_arc = true;      // follow_arc turns the tool about the axis as well
  double gripper = 0;              // position of the gripper's joints at the end, of close and open [m]
  double force = 0;                // close ends where the fingers bear so much each [N]; 0: at `gripper` only
  double duration = 0;             // of close, open and wait; of the others: 0, as fast as the limits allow [s]
  double speed = 0.3;              // share of the velocity and acceleration limits, in (0, 1]
  bool is_straight = true;         // the tool's origin moves on a straight line
  bool avoids_obstacles = false;   // the way to the target is searched around what stands in the scene
};

// As in a task file's `do`.
inline const char* name_of(MotionElement::Type type) {
  constexpr const char* NAMES[] = {"approach", "close", "lift", "carry",      "lower",      "open",
                                   "retreat",  "wait",  "move", "follow_arc", "follow_path"};
  return NAMES[int(type)];
}

}  // namespace pvg
