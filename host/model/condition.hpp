// Conditions of success and of failure: a quantity of the simulated state, a bound, and when it must hold. As data, so
// that a task needs no code of its own.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

// The list of quantities: name, unit (m, rad, or number), what `of` names, the keys that it reads besides
// (ConditionKeys). Names, reading, checks, the resolved file and messages follow from it; pipeline/episode/success.cpp
// has a function of each name, which measures it.
#define PVG_QUANTITIES(X)                                                                                       \
  X(lifted, m, object, NO_KEYS)             /* rise of the object's origin above its start */                   \
  X(position_error, m, object, TARGET_KEYS) /* from its `point` to `target_position` of the target, or world */ \
  X(tilt, rad, object, NO_KEYS)             /* angle between the object's z axis and the vertical */            \
  X(moved_in_hand, m, object, ROBOT_KEY)    /* of its origin in the hand since the grip closed; 0 when free */  \
  X(slip_in_hand, m, object, ROBOT_KEY)     /* of the patch of contact while carried, 0 else */                 \
  X(held, number, object_or_cloth, NO_KEYS) /* bodies of fingers that touch it */                               \
  X(joint_angle, rad, joint, NO_KEYS)       /* coordinate of a joint of `joints`; of a slide in m */            \
  X(corner_distance, m, cloth, POINT_KEYS)  /* between the points that rest at `first` and `second` */          \
  X(edge_distance, m, cloth, EDGE_KEYS)     /* largest along first to first_end and second to second_end */     \
  X(height, m, object_or_cloth, NO_KEYS)    /* of the highest point of a cloth, of an object's origin */

// what a condition reads besides quantity, of, when and its bounds
enum ConditionKeys {
  NO_KEYS = 0,
  TARGET_KEYS = 1,             // target, target_position, point
  ROBOT_KEY = 2,               // robot
  POINT_KEYS = 4,              // first, second
  EDGE_KEYS = POINT_KEYS | 8,  // and first_end, second_end
};

struct Condition {
#define PVG_NAME(name, unit, of, keys) name,
  enum class Quantity { PVG_QUANTITIES(PVG_NAME) };
#undef PVG_NAME
  enum class When { end, some_time, always };
  Quantity quantity = Quantity::lifted;
  When when = When::end;
  std::string of;                                             // object, cloth or joint
  std::string target;                                         // of position_error: an object; empty: the world
  int robot = 0;                                              // whose hand
  Vec3 point = Vec3::Zero(), target_position = Vec3::Zero();  // in the frames of the object and of the target [m]
  // of a cloth at rest, in its frame [m]; the nearest point of the mesh counts
  Vec3 first = Vec3::Zero(), second = Vec3::Zero(), first_end = Vec3::Zero(), second_end = Vec3::Zero();
  std::optional<double> at_least, at_most;
};

struct QuantityKind {
  enum class Unit { number, m, rad };
  enum class Of { object, cloth, object_or_cloth, joint };
  const char* name;  // as in a task file
  Unit unit;
  Of of;
  int keys;  // of ConditionKeys
};
#define PVG_KIND(name, unit, of, keys) QuantityKind{#name, QuantityKind::Unit::unit, QuantityKind::Of::of, keys},
inline constexpr QuantityKind QUANTITY_KINDS[] = {PVG_QUANTITIES(PVG_KIND)};  // in the order of Condition::Quantity
#undef PVG_KIND

constexpr const QuantityKind& kind_of(const Condition& condition) {
  return QUANTITY_KINDS[std::size_t(condition.quantity)];
}

}  // namespace pvg
