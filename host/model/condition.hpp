// Conditions of success and of failure: a quantity of the simulated state, a bound, and when it must hold. As data, so
// that a task needs no code of its own.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

struct Condition {
  enum class Quantity {
    lifted,           // rise of the object's origin above its start [m]
    position_error,   // distance of the object's `point` from `target_position` of the target, or of the world [m]
    tilt,             // angle between the object's z axis and the vertical [rad]
    moved_in_hand,    // move of its origin in the gripper's frame since the grip closed, 0 when free [m]
    slip_in_hand,     // move of the patch of contact against the object while carried, 0 else [m]
    held,             // bodies of fingers that touch the object, or the cloth
    joint_angle,      // coordinate of a joint of `joints` [rad or m]
    corner_distance,  // between the points of a cloth that rest at `first` and `second` [m]
    edge_distance,    // largest between points of a cloth along the line from first to first_end and second to ..._end
    height,           // of the highest point of a cloth, or an object's origin, above z = 0 [m]
  };
  enum class When { end, some_time, always };
  Quantity quantity = Quantity::lifted;
  When when = When::end;
  std::string of;                                             // object, cloth or joint
  std::string target;                                         // of position_error: an object; empty: the world
  int robot = 0;                                              // whose hand, of moved_in_hand
  Vec3 point = Vec3::Zero(), target_position = Vec3::Zero();  // in the frames of the object and of the target [m]
  // of a cloth at rest, in its frame [m]; the nearest point of the mesh counts
  Vec3 first = Vec3::Zero(), second = Vec3::Zero(), first_end = Vec3::Zero(), second_end = Vec3::Zero();
  std::optional<double> at_least, at_most;
};

// As in a task file: lifted, position_error, ...
const std::vector<std::string>& quantity_names();
// "m", "rad" or "": what stands behind its number
const char* unit_of(Condition::Quantity quantity);

}  // namespace pvg
