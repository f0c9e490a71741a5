// A law of a prismatic joint that the scene gives by a formula: joint_law.cl.
#ifndef PVG_ENERGIES_PRISMATIC_LAW_H
#define PVG_ENERGIES_PRISMATIC_LAW_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[3];          // point c_i on the parent, point c_j on the child, unit direction d_i on the parent
  u32 law;              // number of the formula
  f64 lead, rate_length;  // rate (q - q0 - lead) / rate_length, q0: q at the start of the step [m], [s]
  f64 coefficient[32];  // c0, c1, ... [SI]
} PrismaticLaw;
SHARED_SIZE(PrismaticLaw, 288);
ENERGY_TERM(20, prismatic_law, PrismaticLaw, 3);
SHARED_END
#endif
