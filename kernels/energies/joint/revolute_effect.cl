// Friction and springs of a revolute joint:  E = V(q),  V: joint_effect_law.cl,  q: joint_coordinate.cl [J]
#include "energies/joint/joint_coordinate.cl"
#include "energies/joint/joint_effect_law.cl"
#include "energies/joint/revolute_effect.h"

static inline real revolute_effect_energy(const RevoluteEffect p, const real3* x, const real3* x0, const real h) {
  const JointEffectLaw law = JOINT_EFFECT_LAW_OF(p);
  return joint_effect_energy(law, revolute_coordinate(x, x0, p.angle0), p.angle0 + p.lead, p.rate_length);
}

static inline void revolute_effect_gradient(const RevoluteEffect p, const real3* x, const real3* x0, const real h,
                                            real3* g) {
  const JointEffectLaw law = JOINT_EFFECT_LAW_OF(p);
  const real slope = joint_effect_slope(law, revolute_coordinate(x, x0, p.angle0), p.angle0 + p.lead, p.rate_length);
  revolute_derivatives(x, g);
  for (int s = 0; s < 4; ++s) g[s] *= slope;
}

static inline void revolute_effect_hessian(const RevoluteEffect p, const real3* x, const real3* x0, const real h,
                                           real* H) {
  const JointEffectLaw law = JOINT_EFFECT_LAW_OF(p);
  real3 dq[4];
  revolute_derivatives(x, dq);
  const real curvature = joint_effect_curvature(law, revolute_coordinate(x, x0, p.angle0), p.angle0 + p.lead, p.rate_length);
  joint_hessian(curvature, 4, dq, H);
}

#define TERM revolute_effect
#define PARAMS RevoluteEffect
#define STENCIL 4
#include "energies/assemble.cl"
