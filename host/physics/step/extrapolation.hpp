// Where Newton's method starts: every body moved on by its velocity as it will be, if the change of velocity of the
// last step goes on; rotation as rotation. For a body with nodes x, such velocities v, centre c and rigid part (v_c,
// omega) of its motion:
//   x* = c + h v_c + exp(h omega) (x - c) + h (v - v_c - omega x (x - c))
// A straight step instead would stretch a stiff body by (h |omega|)^2 / 2, which Newton must then undo.
#pragma once
#include <span>
#include <vector>

#include "host/physics/energies/system.hpp"

namespace pvg {

// With the last two changes of velocity a = v - v_before and b = v_before - v_two_before, in a world where b foretold
// most of a:  v + k a, k = a.b / max(a.a, b.b); elsewhere, as at contacts that come and go, and where the step before
// was of another length (goes_on: [n_worlds]):  v                                                      [n_nodes x 3,
// m/s]
std::vector<double> extrapolated_velocities(const System& system, const std::vector<double>& v,
                                            const std::vector<double>& v_before,
                                            const std::vector<double>& v_two_before, std::span<const char> goes_on);

// x, v: [n_nodes x 3] -> x* - x [n_nodes x 3, m]; zero for fixed bodies
std::vector<double> extrapolated_motion(const System& system, const std::vector<double>& x,
                                        const std::vector<double>& v, double h);

}  // namespace pvg
