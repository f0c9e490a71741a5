// A force on a body that follows the position and velocity of its centre of mass by formulas:
//   F = f(x + h v / 2, v),   x, v: at the start of the step, f: [N]
// Kept over the step as the constant force of a row of `point_force`; explicit, so exact to the first order in h.
//   FORCE_LAWS: `case NUMBER: return (real3)(X, Y, Z);` of each law, made by the host (host/physics/energies/laws.cpp)
#include "energies/body/point_force.h"
#include "energies/body/force_law.h"
#include "shared/real.h"

#ifndef FORCE_LAWS
#define FORCE_LAWS
#endif

// c: coefficients
static inline real3 force_of(const uint law, const real x, const real y, const real z, const real vx, const real vy,
                             const real vz, const real* c) {
  switch (law) { FORCE_LAWS }
  return (real3)(0);
}

// laws: [n];  forces: of the term;  x, v: sites at the start of the step [n_sites x 3] [m], [m/s];  h [s]
kernel void force_law(const uint n, global const ForceLaw* restrict laws, global PointForce* forces,
                      global const real* restrict x, global const real* restrict v, const real h) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const ForceLaw p = laws[i];
  const uint site = forces[p.row].site[0];
  const real3 velocity = vload3(site, v), at = vload3(site, x) + 0.5 * h * velocity;
  vstore3(force_of(p.law, at.x, at.y, at.z, velocity.x, velocity.y, velocity.z, p.coefficient), 0, forces[p.row].force);
}
