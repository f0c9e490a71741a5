// The largest numbers that a drive of a scene, or what a scene begins with, may be told.
#pragma once
#include "host/load/fields/fields.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg {

constexpr double FASTEST = 1e3;                // [m/s]
constexpr double MOST_TURNS = 1e4;             // [rad/s]
constexpr double LARGEST_JOINT_ANGLE = 1e3;    // counted in turns [rad]
constexpr double LARGEST_JOINT_NUMBER = 1e12;  // stiffness, damping, effort

inline bool turns(Joint::Type type) { return type == Joint::Type::revolute; }
inline double largest_coordinate(Joint::Type type) { return turns(type) ? LARGEST_JOINT_ANGLE : REACH; }

// in the unit of the mode: rad or m, rad/s or m/s, N m or N
inline double largest_target(Joint::Type type, Drive::Mode mode) {
  if (mode == Drive::Mode::velocity) return turns(type) ? MOST_TURNS : FASTEST;
  return mode == Drive::Mode::torque ? LARGEST_JOINT_NUMBER : largest_coordinate(type);
}

}  // namespace pvg
