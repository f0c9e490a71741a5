// What brakes the turning of a rigid body.
#ifndef PVG_ENERGIES_SPIN_H
#define PVG_ENERGIES_SPIN_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[3];  // the axes a1, a2, a3 of the body
  u32 unused;
  f64 drag;      // c [N m s/rad], >= 0
  f64 torque;    // T, the same at every speed [N m], >= 0
  f64 velocity;  // where T is fully developed [rad/s]
  f64 unused_;
} Spin;
SHARED_SIZE(Spin, 48);
ENERGY_TERM(14, spin, Spin, 3);
SHARED_END
#endif
