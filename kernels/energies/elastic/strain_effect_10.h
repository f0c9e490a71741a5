// What the material of a tetrahedron with 10 nodes adds to its elasticity.
#ifndef PVG_ENERGIES_STRAIN_EFFECT_10_H
#define PVG_ENERGIES_STRAIN_EFFECT_10_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[10];         // as of StableNeoHookean10
  f64 rest_inverse[9];  // Dm^-1, row-major, Dm = [X1-X0, X2-X0, X3-X0] of the rest shape's corners [1/m]
  f64 volume;           // at rest [m^3]
  f64 stiffening;       // mu beta [Pa]
  f64 viscosity;        // eta [Pa s]
  f64 hysteresis;       // 2 mu chi [Pa]
  f64 strain_rate;      // where hysteresis is fully developed [1/s]
  f64 unused_;
} StrainEffect10;
SHARED_SIZE(StrainEffect10, 160);
ENERGY_TERM(16, strain_effect_10, StrainEffect10, 10);
SHARED_END
#endif
