// A law of a revolute joint that the scene gives by a formula: joint_law.cl.
#ifndef PVG_ENERGIES_REVOLUTE_LAW_H
#define PVG_ENERGIES_REVOLUTE_LAW_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[4];  // directions n_i, b_i on the parent, n_j, b_j on the child, as of its drive
  u32 law;      // number of the formula
  u32 unused;
  f64 angle0;           // q at the start of the step, whole turns included [rad]
  f64 lead, rate_length;  // rate (q - q0 - lead) / rate_length, q0: q at the start of the step [rad], [s]
  f64 coefficient[32];  // c0, c1, ... [SI]
} RevoluteLaw;
SHARED_SIZE(RevoluteLaw, 304);
ENERGY_TERM(19, revolute_law, RevoluteLaw, 4);
SHARED_END
#endif
