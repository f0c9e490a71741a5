// Friction and springs of a prismatic joint:  E = V(q),  V: joint_effect_law.cl,  q: joint_coordinate.cl [J]
#include "energies/joint/joint_coordinate.cl"
#include "energies/joint/joint_effect_law.cl"
#include "energies/joint/prismatic_effect.h"

static inline real prismatic_effect_energy(const PrismaticEffect p, const real3* x, const real3* x0, const real h) {
  const JointEffectLaw law = JOINT_EFFECT_LAW_OF(p);
  return joint_effect_energy(law, prismatic_coordinate(x), prismatic_coordinate(x0) + p.lead, p.rate_length);
}

static inline void prismatic_effect_gradient(const PrismaticEffect p, const real3* x, const real3* x0, const real h,
                                             real3* g) {
  const JointEffectLaw law = JOINT_EFFECT_LAW_OF(p);
  const real slope = joint_effect_slope(law, prismatic_coordinate(x), prismatic_coordinate(x0) + p.lead, p.rate_length);
  prismatic_derivatives(x, g);
  for (int s = 0; s < 3; ++s) g[s] *= slope;
}

static inline void prismatic_effect_hessian(const PrismaticEffect p, const real3* x, const real3* x0, const real h,
                                            real* H) {
  const JointEffectLaw law = JOINT_EFFECT_LAW_OF(p);
  real3 dq[3];
  prismatic_derivatives(x, dq);
  const real curvature = joint_effect_curvature(law, prismatic_coordinate(x), prismatic_coordinate(x0) + p.lead, p.rate_length);
  joint_hessian(curvature, 3, dq, H);
}

#define TERM prismatic_effect
#define PARAMS PrismaticEffect
#define STENCIL 3
#include "energies/assemble.cl"
