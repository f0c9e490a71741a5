// Where Newton's method starts: every body moved on by its velocity, rotation as rotation. For a body with nodes x,
// velocities v, centre c and rigid part (v_c, omega) of its motion:
//   x* = c + h v_c + exp(h omega) (x - c) + h (v - v_c - omega x (x - c))
// A straight step instead would stretch a stiff body by (h |omega|)^2 / 2, which Newton must then undo.
#pragma once
#include <vector>

#include "host/physics/energies/system.hpp"

namespace pvg {

// x, v: [n_nodes x 3] -> x* - x [n_nodes x 3, m]; zero for fixed bodies
std::vector<double> extrapolated_motion(const System& system, const std::vector<double>& x,
                                        const std::vector<double>& v, double h);

}  // namespace pvg
