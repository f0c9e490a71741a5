// How the coefficient of friction of a lagged contact depends on its sliding, and what its approach dissipates, as the
// effects on its pair of bodies say:
//   mu <- mu (1 + change (1 - exp(-v / velocity))) sqrt(cos^2 + (1 + across)^2 sin^2)
// v: lagged sliding speed, the angle: between its direction and a direction of the first body.
#pragma once
#include <span>
#include <vector>

#include "energies/contact/friction.h"
#include "host/physics/contact/collision_mesh.hpp"

namespace pvg {

bool changes_friction(const ContactEffect& effect);

// x0, x1: sites at the start of a step and where they are thought to come [n_sites x 3, m]; h: its length [s]
void apply_slip_effects(std::span<const ContactEffect> effects, std::span<const double> x0, std::span<const double> x1,
                        double h, std::span<Friction> rows);

}  // namespace pvg
