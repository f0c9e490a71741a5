// The stops of a prismatic joint.
#ifndef PVG_ENERGIES_PRISMATIC_LIMIT_H
#define PVG_ENERGIES_PRISMATIC_LIMIT_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[3];  // point c_i on the parent, point c_j on the child, unit direction d_i on the parent
  u32 unused;
  f64 stiffness;     // of the stop [N/m]
  f64 lower, upper;  // [m], lower <= upper
  f64 unused_too;
} PrismaticLimit;
SHARED_SIZE(PrismaticLimit, 48);
ENERGY_TERM(10, prismatic_limit, PrismaticLimit, 3);
SHARED_END
#endif
