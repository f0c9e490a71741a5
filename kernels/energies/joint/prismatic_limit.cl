// Stops of a prismatic joint:  E = k/2 e^2,  e = max(q - upper, 0) + min(q - lower, 0) [J] A stop is a stiff spring
// that acts beyond the limit only, so q passes it by (effort / k). q: joint_coordinate.cl
#include "energies/joint/joint_coordinate.cl"
#include "energies/joint/prismatic_limit.h"

static inline real prismatic_limit_excess(const PrismaticLimit p, const real3* x, const real3* x0) {
  const real q = prismatic_coordinate(x);
  return fmax(q - p.upper, (real)0) + fmin(q - p.lower, (real)0);
}

static inline real prismatic_limit_energy(const PrismaticLimit p, const real3* x, const real3* x0, const real h) {
  const real excess = prismatic_limit_excess(p, x, x0);
  return 0.5 * p.stiffness * excess * excess;
}

static inline void prismatic_limit_gradient(const PrismaticLimit p, const real3* x, const real3* x0, const real h,
                                            real3* g) {
  const real slope = p.stiffness * prismatic_limit_excess(p, x, x0);
  prismatic_derivatives(x, g);
  for (int s = 0; s < 3; ++s) g[s] *= slope;
}

static inline void prismatic_limit_hessian(const PrismaticLimit p, const real3* x, const real3* x0, const real h,
                                           real* H) {
  real3 dq[3];
  prismatic_derivatives(x, dq);
  joint_hessian(prismatic_limit_excess(p, x, x0) != 0 ? p.stiffness : 0, 3, dq, H);
}

#define TERM prismatic_limit
#define PARAMS PrismaticLimit
#define STENCIL 3
#include "energies/assemble.cl"
