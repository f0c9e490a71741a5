// A law of a prismatic joint, given by a formula:  E = V(q),  V: joint_law.cl,  q: joint_coordinate.cl [J]
#include "energies/joint/joint_coordinate.cl"
#include "energies/joint/joint_law.cl"
#include "energies/joint/prismatic_law.h"

static inline real prismatic_law_energy(const PrismaticLaw p, const real3* x, const real3* x0, const real h) {
  return joint_law_energy(p.law, prismatic_coordinate(x), prismatic_coordinate(x0) + p.lead, p.rate_length,
                          p.coefficient);
}

static inline void prismatic_law_gradient(const PrismaticLaw p, const real3* x, const real3* x0, const real h,
                                          real3* g) {
  const real slope = joint_law_slope(p.law, prismatic_coordinate(x), prismatic_coordinate(x0) + p.lead, p.rate_length,
                                     p.coefficient);
  prismatic_derivatives(x, g);
  for (int s = 0; s < 3; ++s) g[s] *= slope;
}

static inline void prismatic_law_hessian(const PrismaticLaw p, const real3* x, const real3* x0, const real h, real* H) {
  real3 dq[3];
  prismatic_derivatives(x, dq);
  const real curvature = joint_law_curvature(p.law, prismatic_coordinate(x), prismatic_coordinate(x0) + p.lead,
                                             p.rate_length, p.coefficient);
  joint_hessian(curvature, 3, dq, H);
}

#define TERM prismatic_law
#define PARAMS PrismaticLaw
#define STENCIL 3
#include "energies/assemble.cl"
