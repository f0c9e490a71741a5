// Where a simulation starts, and what is not known of it.
#pragma once
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg::diagnose {

// Where a window starts: coordinates of open chains and free bodies.
struct InitialState {
  std::vector<double> position, rate;  // [n_joints, rad or m], [rad/s or m/s]
  std::vector<Pose> pose;              // [n_rigid], counts for free bodies
  std::vector<Vec3> velocity, spin;    // [n_rigid] world [m/s], [rad/s]
};

// One number of a start that is known with an error only; it is fitted with everything else.
struct Unknown {
  enum class Kind { joint_position, joint_rate, position, rotation, velocity, spin };
  Kind kind = Kind::joint_position;
  int index = -1;                  // joint or rigid body
  Vec3 direction = Vec3::UnitX();  // of the last four
  double sigma = 1;                // how well it is known before the fit
};

// One number of a run's start that the recording states: the unknown's coordinate is `value`, along its direction; with
// a sigma of 0 exactly.
struct GivenStart {
  Unknown unknown;
  double value = 0;
};

}  // namespace pvg::diagnose
