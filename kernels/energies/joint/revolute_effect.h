// Friction and springs of a revolute joint. The law: joint_effect_law.cl.
#ifndef PVG_ENERGIES_REVOLUTE_EFFECT_H
#define PVG_ENERGIES_REVOLUTE_EFFECT_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[4];            // directions n_i, b_i on the parent, n_j, b_j on the child, as of its drive
  f64 stiffness;          // [N m/rad]
  f64 preload;            // [N m]
  f64 damping;            // [N m s/rad]
  f64 coulomb, extra;     // friction while it slides, and what sticking adds to it [N m]
  f64 stribeck_velocity;  // over which the latter fades [rad/s]
  f64 velocity;           // at which friction is fully developed [rad/s]
  f64 angle0;             // q at the start of the step, whole turns included [rad]
  f64 lead, rate_length;  // rate (q - q0 - lead) / rate_length, q0: q at the start of the step [rad], [s]
} RevoluteEffect;
SHARED_SIZE(RevoluteEffect, 96);
ENERGY_TERM(11, revolute_effect, RevoluteEffect, 4);
SHARED_END
#endif
