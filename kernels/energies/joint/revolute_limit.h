// The stops of a revolute joint.
#ifndef PVG_ENERGIES_REVOLUTE_LIMIT_H
#define PVG_ENERGIES_REVOLUTE_LIMIT_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[4];       // directions n_i, b_i on the parent, n_j, b_j on the child; b = axis x n; equal at q = 0
  f64 stiffness;     // of the stop [N m/rad]
  f64 lower, upper;  // [rad], lower <= upper
  f64 angle0;        // q at the start of the step, whole turns included [rad]
} RevoluteLimit;
SHARED_SIZE(RevoluteLimit, 48);
ENERGY_TERM(9, revolute_limit, RevoluteLimit, 4);
SHARED_END
#endif
