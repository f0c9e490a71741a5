// Rigid bodies that move as told. Such a body is simulated like any other, but its inertia is that of 1e6 kg about
// where it is to be at the end of the step instead of about where its momentum leads, and no weight acts on it:
//   E = |x - x(t + h)|^2_M / (2 h^2),   stiffness towards its path M / h^2: 1e10 N/m at h = 10 ms
// So it takes part in the same certified steps as everything else and can never cut into anything: where something that
// does not yield stands in its way it stays behind and presses.
#pragma once
#include "host/physics/energies/system.hpp"

namespace pvg {

// Where the body is to be at `time` [s].
Pose prescribed_pose(const RigidBody& body, double time);

// As affine_mass_matrix, of the mass that holds it to its path.
Eigen::Matrix4d prescribed_mass_matrix(const RigidBody& body);

bool has_prescribed_bodies(const System& system);

// Writes where the prescribed bodies of one world are to be at `time` over their nodes.  nodes: [n_nodes x 3, m]
void write_prescribed(const System& system, std::size_t world, double time, std::vector<double>& nodes);

}  // namespace pvg
