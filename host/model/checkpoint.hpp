// Everything that the next step depends on beside the scene: a simulation made from the same scenes and restored from
// this goes on with the same bits.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

using PairKey = std::array<std::uint32_t, 5>;  // kind and sites of a contact

// What a sticking contact remembers (physics/contact/friction_anchors.hpp).
struct FrictionAnchor {
  PairKey pair{};
  Vec3 strain = Vec3::Zero();  // s, |s| <= 1, in the world's frame [-]
};

// What time integration keeps of the past.  [n_nodes x 3]
struct MotionHistory {
  std::vector<double> velocity, position_before, velocity_before;  // [m/s], [m], [m/s]
  std::vector<double> velocity_two_before;                         // at the start of the step before the last [m/s]
  std::vector<double> length_before;                               // [n_worlds] of the step before [s]; 0: none
};

struct Checkpoint {
  std::vector<double> position;  // of all nodes of all worlds [n_nodes x 3, m]
  MotionHistory history;
  std::vector<std::vector<FrictionAnchor>> anchors;  // [n_worlds] of their contacts
  std::vector<double> time;                          // [n_worlds, s]
  std::vector<std::vector<double>> joint_position;   // [n_worlds][n_joints, rad or m] whole turns included
  std::vector<std::vector<double>> targets;          // [n_worlds][n_driven, rad or m] of the last step
  std::vector<std::vector<double>> couplings;        // [n_worlds][n_pairs x 2] nodes, as the preconditioner holds them
  std::vector<std::vector<double>> past_targets;     // [n_worlds][n_past x n_driven] that delayed drives still obey
  std::vector<double> pressing;                      // normal forces that rolling resistance goes by [N]
  std::vector<std::vector<double>> reading;          // [n_worlds][n_displays, kg]
  std::vector<double> flowed;                        // rest shapes of elements that yield or creep [n x 9, 1/m]
  std::vector<std::vector<double>> joint_motion;     // [n_worlds][4 n_joints] physics/step/joint_motion.hpp
};

}  // namespace pvg
