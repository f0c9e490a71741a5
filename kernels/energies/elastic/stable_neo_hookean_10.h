// Stable neo-Hookean tetrahedron with 10 nodes, straight-sided at rest.
#ifndef PVG_ENERGIES_STABLE_NEO_HOOKEAN_10_H
#define PVG_ENERGIES_STABLE_NEO_HOOKEAN_10_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[10];         // corners 0 1 2 3, then the midpoints of edges 01 12 02 03 13 23
  f64 rest_inverse[9];  // Dm^-1, row-major, Dm = [X1-X0, X2-X0, X3-X0] of the rest shape's corners [1/m]
  f64 volume;           // at rest, det(Dm) / 6 [m^3]
  f64 mu, lambda;       // Lame parameters: mu = E / (2 (1 + nu)), lambda = E nu / ((1 + nu)(1 - 2 nu)) [Pa]
  f64 unused;
} StableNeoHookean10;
SHARED_SIZE(StableNeoHookean10, 144);
ENERGY_TERM(4, stable_neo_hookean_10, StableNeoHookean10, 10);
SHARED_END
#endif
