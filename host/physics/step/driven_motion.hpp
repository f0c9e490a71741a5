// Where drives lead a robot in a step: a stiff drive's joint moves as its target does, which is known before the step
// is solved, while velocities do not show how a motion that speeds up goes on. With the change e of each coordinate the
// links turn and slide about their joints one after the other, exactly, and what they carry with them:
//   T_child = T_parent J(e),   motion of a link = T x - x
// Soft bodies stitched to links, and free solids that touch these or links, are moved from where their velocities lead
// by as much as the links are: in the mean over stitched nodes, or over contacts weighted by normal force.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "energies/contact/friction.h"
#include "host/physics/energies/joint.hpp"
#include "host/physics/energies/system.hpp"
#include "host/physics/step/joint_motion.hpp"

namespace pvg {

// The changes of a world's coordinates in the next step, as long as the last one [n_joints, rad or m]: that of the
// target for a joint that followed its own in the last step and carries nothing that touches what does not go with it;
// of others the last one. Nothing where there is no joint of the former kind. carried, motion, q (coordinates now):
// [n_joints]; target_change: of drives of position over the next step, 0 without one [n_joints, rad or m]; contacts: of
// all worlds now, bodies numbered over all worlds
std::optional<std::vector<double>> foreseen_changes(const System& system, std::size_t world,
                                                    std::span<const Carried> carried,
                                                    std::span<const JointMotion> motion, std::span<const double> q,
                                                    std::span<const double> target_change,
                                                    std::span<const Friction> contacts);

// Sets the motion of what the drives of a world carry.
// x: nodes at the start [n_nodes x 3, m];  by_velocity: where velocities lead them, less x [n_nodes x 3, m];
// contacts: as above;  motion: [n_nodes x 3, m]
void follow_drives(const System& system, std::size_t world, std::span<const double> changes,
                   std::span<const Friction> contacts, const std::vector<double>& x,
                   const std::vector<double>& by_velocity, std::vector<double>& motion);

}  // namespace pvg
