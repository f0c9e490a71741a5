// What rubber adds to a stable neo-Hookean tetrahedron with 10 nodes.
#ifndef PVG_ENERGIES_HYPERELASTIC_10_H
#define PVG_ENERGIES_HYPERELASTIC_10_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[10];         // as of StableNeoHookean10
  f64 rest_inverse[9];  // Dm^-1, row-major, Dm = [X1-X0, X2-X0, X3-X0] of the rest shape's corners [1/m]
  f64 volume;           // at rest [m^3]
  f64 yeoh_2, yeoh_3;   // C20 and C30 [Pa]
  f64 ogden;            // share of the shear modulus [Pa]
  f64 exponent;         // of the stretches in Ogden's term, not 0 [1]
  f64 logarithm;        // mu where the neo-Hookean density has the logarithm, else 0 [Pa]
} Hyperelastic10;
SHARED_SIZE(Hyperelastic10, 160);
ENERGY_TERM(22, hyperelastic_10, Hyperelastic10, 10);
SHARED_END
#endif
