// A law of a revolute joint, given by a formula:  E = V(q),  V: joint_law.cl,  q: joint_coordinate.cl [J]
#include "energies/joint/joint_coordinate.cl"
#include "energies/joint/joint_law.cl"
#include "energies/joint/revolute_law.h"

static inline real revolute_law_energy(const RevoluteLaw p, const real3* x, const real3* x0, const real h) {
  return joint_law_energy(p.law, revolute_coordinate(x, x0, p.angle0), p.angle0 + p.lead, p.rate_length, p.coefficient);
}

static inline void revolute_law_gradient(const RevoluteLaw p, const real3* x, const real3* x0, const real h, real3* g) {
  const real slope = joint_law_slope(p.law, revolute_coordinate(x, x0, p.angle0), p.angle0 + p.lead, p.rate_length,
                                     p.coefficient);
  revolute_derivatives(x, g);
  for (int s = 0; s < 4; ++s) g[s] *= slope;
}

static inline void revolute_law_hessian(const RevoluteLaw p, const real3* x, const real3* x0, const real h, real* H) {
  real3 dq[4];
  revolute_derivatives(x, dq);
  const real q = revolute_coordinate(x, x0, p.angle0);
  joint_hessian(joint_law_curvature(p.law, q, p.angle0 + p.lead, p.rate_length, p.coefficient), 4, dq, H);
}

#define TERM revolute_law
#define PARAMS RevoluteLaw
#define STENCIL 4
#include "energies/assemble.cl"
