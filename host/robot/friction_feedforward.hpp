// Friction feedforward of a planned motion: by how much a drive's targets must lead the wanted coordinate q so that
// friction does not hold it back. With stiffness k and damping d of the drive, the lead e = target - q, and v = dq/dt,
//   d de/dt + k e = F(v),   F(v) = c v + (T + S exp(-(v / u)^2)) s(v),   s(v) = sign(v) (2 - |v| / eps) |v| / eps for
//   |v| < eps, else sign(v)
// (viscous, Coulomb and Stribeck friction of the joint: kernels/energies/joint/joint_effect_law.cl), by implicit Euler:
//   e_n = (F(v_n) + d / h e_(n-1)) / (k + d / h)
// A drive that damps the joint's own rate has d in c instead. Inertia is not fed forward.
#pragma once
#include <span>
#include <vector>

#include "host/model/physical_scene.hpp"

namespace pvg {

// effects: of the scene; those of this joint count, as far as they are friction. start: q before the first step [rad or
// m]; q: [n_steps] at the ends of steps of the length time_step [s]. -> [n_steps] e; zero where the drive holds no
// position.
std::vector<double> friction_lead(const Joint& joint, std::span<const Effect> effects, double start,
                                  std::span<const double> q, double time_step);

}  // namespace pvg
