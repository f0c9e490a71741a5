// A force on a body that the scene gives by formulas.
#ifndef PVG_ENERGIES_FORCE_LAW_H
#define PVG_ENERGIES_FORCE_LAW_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 row;  // of point_force, at whose site the force acts
  u32 law;  // number of the three formulas
  f64 unused;
  f64 coefficient[32];  // c0, c1, ... [SI]
} ForceLaw;
SHARED_SIZE(ForceLaw, 272);
SHARED_END
#endif
