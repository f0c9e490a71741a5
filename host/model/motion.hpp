// Motion elements: what the robots do, one after the other, each relative to an object of the scene.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "host/model/scene.hpp"

namespace pvg {

// The list of motion elements: name, what is given (GivenMotion), what becomes of the grip (GripChange). Names,
// reading, the resolved file and the phases of an episode follow from it; host/robot/plan_motion.cpp plans by what is
// given.
#define PVG_MOTION_ELEMENTS(X)       \
  X(approach, target, same)          \
  X(close, gripper_position, closes) \
  X(lift, target, same)              \
  X(carry, target, carries)          \
  X(lower, target, same)             \
  X(open, gripper_position, opens)   \
  X(retreat, target, same)           \
  X(wait, duration, same)            \
  X(move, target, same)              \
  X(follow_arc, arc, carries)        \
  X(follow_path, path, carries)

// target, arc, path: where the tool goes; gripper_position: where the gripper's joints go; duration: nothing moves
enum class GivenMotion { target, arc, path, gripper_position, duration };
// closes: the hand holds from the end of the element on; carries: an object that is held travels
enum class GripChange { same, closes, opens, carries };

struct MotionElement {
#define PVG_NAME(name, given, grip) name,
  enum class Type { PVG_MOTION_ELEMENTS(PVG_NAME) };
#undef PVG_NAME
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
  bool avoids_obstacles = false;   // the path to the target is planned around what stands in the scene
  double blend_radius = 0;         // the arm goes on into the next element within it of the target [m]; 0: it stops
  std::string place = {};          // FILE:LINE of the task, for messages; empty: unknown
};

struct MotionKind {
  const char* name;  // as in a task file's `do`
  GivenMotion given;
  GripChange grip;
};
#define PVG_KIND(name, given, grip) MotionKind{#name, GivenMotion::given, GripChange::grip},
inline constexpr MotionKind MOTION_KINDS[] = {PVG_MOTION_ELEMENTS(PVG_KIND)};  // in the order of Type
#undef PVG_KIND

constexpr const MotionKind& kind_of(const MotionElement& element) { return MOTION_KINDS[std::size_t(element.type)]; }

}  // namespace pvg
