// Inertia of one node: E = m |x - x~|^2 / (2 h^2)                                        [J]
// x0 is the predicted position x~ here.
#include "energies/body/inertia.h"
#include "shared/real.h"

static inline real point_inertia_energy(const PointInertia p, const real3* x, const real3* x0, const real h) {
  const real3 d = x[0] - x0[0];
  return p.mass * dot(d, d) / (2 * h * h);
}

static inline void point_inertia_gradient(const PointInertia p, const real3* x, const real3* x0, const real h,
                                          real3* g) {
  g[0] = p.mass / (h * h) * (x[0] - x0[0]);
}

static inline void point_inertia_hessian(const PointInertia p, const real3* x, const real3* x0, const real h, real* H) {
  for (int i = 0; i < 9; ++i) H[i] = i % 4 == 0 ? p.mass / (h * h) : 0;
}

#define TERM point_inertia
#define PARAMS PointInertia
#define STENCIL 1
#include "energies/assemble.cl"
