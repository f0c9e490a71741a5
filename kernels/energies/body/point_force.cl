// Force and drag at a point, d = x - x0:  E = -F . d + c |d|^2 / (2 h) + k |d|^3 / (3 h^2)                          [J]
// so the force on it is F - c v - k |v| v with v = d / h.
#include "energies/body/point_force.h"
#include "shared/real.h"

static inline real point_force_energy(const PointForce p, const real3* x, const real3* x0, const real h) {
  const real3 d = x[0] - x0[0];
  const real y = length(d);
  return -dot(vload3(0, p.force), d) + y * y * (p.linear / (2 * h) + p.quadratic * y / (3 * h * h));
}

static inline void point_force_gradient(const PointForce p, const real3* x, const real3* x0, const real h, real3* g) {
  const real3 d = x[0] - x0[0];
  g[0] = -vload3(0, p.force) + (p.linear / h + p.quadratic * length(d) / (h * h)) * d;
}

static inline void point_force_hessian(const PointForce p, const real3* x, const real3* x0, const real h, real* H) {
  const real3 d3 = x[0] - x0[0];
  const real y = length(d3), k = p.quadratic / (h * h), d[3] = {d3.x, d3.y, d3.z};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) H[3 * i + j] = (i == j ? p.linear / h + k * y : 0) + (y > 0 ? k * d[i] * d[j] / y : 0);
}

#define TERM point_force
#define PARAMS PointForce
#define STENCIL 1
#include "energies/assemble.cl"
