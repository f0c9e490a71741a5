// Stops of a revolute joint:  E = k/2 e^2,  e = max(q - upper, 0) + min(q - lower, 0) [J] A stop is a stiff spring that
// acts beyond the limit only, so q passes it by (effort / k). q: joint_coordinate.cl
#include "energies/joint/joint_coordinate.cl"
#include "energies/joint/revolute_limit.h"

static inline real revolute_limit_excess(const RevoluteLimit p, const real3* x, const real3* x0) {
  const real q = revolute_coordinate(x, x0, p.angle0);
  return fmax(q - p.upper, (real)0) + fmin(q - p.lower, (real)0);
}

static inline real revolute_limit_energy(const RevoluteLimit p, const real3* x, const real3* x0, const real h) {
  const real excess = revolute_limit_excess(p, x, x0);
  return 0.5 * p.stiffness * excess * excess;
}

static inline void revolute_limit_gradient(const RevoluteLimit p, const real3* x, const real3* x0, const real h,
                                           real3* g) {
  const real slope = p.stiffness * revolute_limit_excess(p, x, x0);
  revolute_derivatives(x, g);
  for (int s = 0; s < 4; ++s) g[s] *= slope;
}

static inline void revolute_limit_hessian(const RevoluteLimit p, const real3* x, const real3* x0, const real h,
                                          real* H) {
  real3 dq[4];
  revolute_derivatives(x, dq);
  joint_hessian(revolute_limit_excess(p, x, x0) != 0 ? p.stiffness : 0, 4, dq, H);
}

#define TERM revolute_limit
#define PARAMS RevoluteLimit
#define STENCIL 4
#include "energies/assemble.cl"
