// Force and drag at a point.
#ifndef PVG_ENERGIES_POINT_FORCE_H
#define PVG_ENERGIES_POINT_FORCE_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[1];
  u32 unused;
  f64 force[3];   // F [N]
  f64 linear;     // c [N s/m], >= 0
  f64 quadratic;  // k [N s^2/m^2], >= 0
} PointForce;
SHARED_SIZE(PointForce, 48);
ENERGY_TERM(13, point_force, PointForce, 1);
SHARED_END
#endif
