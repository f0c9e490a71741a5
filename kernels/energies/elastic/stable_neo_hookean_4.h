// Stable neo-Hookean tetrahedron with 4 nodes.
#ifndef PVG_ENERGIES_STABLE_NEO_HOOKEAN_4_H
#define PVG_ENERGIES_STABLE_NEO_HOOKEAN_4_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[4];          // corners, det [x1-x0, x2-x0, x3-x0] > 0 at rest
  f64 rest_inverse[9];  // Dm^-1, row-major, Dm = [X1-X0, X2-X0, X3-X0] of the rest shape [1/m]
  f64 volume;           // at rest, det(Dm) / 6 [m^3]
  f64 mu, lambda;       // Lame parameters: mu = E / (2 (1 + nu)), lambda = E nu / ((1 + nu)(1 - 2 nu)) [Pa]
} StableNeoHookean4;
SHARED_SIZE(StableNeoHookean4, 112);
ENERGY_TERM(3, stable_neo_hookean_4, StableNeoHookean4, 4);
SHARED_END
#endif
