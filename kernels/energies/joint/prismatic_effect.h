// Friction and springs of a prismatic joint. The law: joint_effect_law.cl.
#ifndef PVG_ENERGIES_PRISMATIC_EFFECT_H
#define PVG_ENERGIES_PRISMATIC_EFFECT_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[3];  // point c_i on the parent, point c_j on the child, unit direction d_i on the parent
  u32 unused;
  f64 stiffness;          // [N/m]
  f64 preload;            // [N]
  f64 damping;            // [N s/m]
  f64 coulomb, extra;     // friction while it slides, and what sticking adds to it [N]
  f64 stribeck_velocity;  // over which the latter fades [m/s]
  f64 velocity;           // at which friction is fully developed [m/s]
  f64 lead, rate_length;  // rate (q - q0 - lead) / rate_length, q0: q at the start of the step [m], [s]
  f64 unused_;
} PrismaticEffect;
SHARED_SIZE(PrismaticEffect, 96);
ENERGY_TERM(12, prismatic_effect, PrismaticEffect, 3);
SHARED_END
#endif
