// How fast the coordinates of joints move, integrated as nodes are (time_integration.hpp): what a joint's armature
// resists.
#pragma once
#include <vector>

#include "host/model/physical_scene.hpp"

namespace pvg {

// Of one joint.  [rad or m], [rad/s or m/s]
struct JointMotion {
  double before = 0;         // coordinate at the start of the last step
  double rate = 0;           // at its end
  double rate_before = 0;    // at its start
  double target_change = 0;  // of its drive of position in the last step, 0 without one
};

// Rates along the coordinates of all joints, as the bodies start; 0 for fixed and spherical ones.  [n_joints]
std::vector<JointMotion> initial_motion(const PhysicalScene& scene);

// Where a coordinate q comes from in a step, x* of time integration [rad or m].
double past_coordinate(const JointMotion& motion, double q, bool is_second_order);
// The rate at the end of a step is (q - q0 - lead) / h', q0: q at its start; lead as the step begins [rad or m].
double rate_lead(const JointMotion& motion, double q, bool is_second_order);
// How inertia alone would change it: x* + h' v* - q [rad or m].
double foreseen_change(const JointMotion& motion, double q, bool is_second_order, double inertia_h);
// After a step from q_start to q_end.
JointMotion after_step(const JointMotion& motion, double q_start, double q_end, bool is_second_order, double inertia_h);

// As numbers of a checkpoint [4 n_joints], and back.
std::vector<double> to_numbers(const std::vector<JointMotion>& motion);
std::vector<JointMotion> to_motion(const std::vector<double>& numbers);

}  // namespace pvg
