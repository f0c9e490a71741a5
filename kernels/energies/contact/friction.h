// Smoothed Coulomb friction of one lagged contact: parameters. The formulas stand in friction.cl.
#ifndef PVG_ENERGIES_FRICTION_H
#define PVG_ENERGIES_FRICTION_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[4];
  u32 kind;  // as in Barrier
  u32 body[2];
  u32 world;
  f64 coefficient[4];     // c: closest difference = sum_i c_i x_i, first body positive
  f64 normal[3];          // unit, from the second body to the first
  f64 normal_force;       // lambda [N], lagged
  f64 friction;           // mu
  f64 friction_velocity;  // epsilon_v: slower sliding counts as sticking [m/s]
  f64 anchor[3];          // e: sliding carried over from earlier steps [m]
  f64 dissipation;        // chi: of the approach along the normal [s/m]
} Friction;
SHARED_SIZE(Friction, 144);

// Of one lagged contact where its Hessian was made last. The formulas stand in primal_dual_friction.cl.
typedef struct {
  f64 sliding[3];  // u, in the tangent plane [m]
  f64 pull[3];     // sigma: friction as an unknown of its own, of mu lambda
} FrictionDual;
SHARED_SIZE(FrictionDual, 48);
SHARED_END
#endif
