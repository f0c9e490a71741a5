// What brakes the turning of a rigid body:  E = c y^2 / (2 h) + T f0(y),  y = sqrt(sum_k |a_k - a0_k|^2 / 2)        [J]
// The axes of a body that turns at omega move at omega x a_k, whose squares sum to 2 omega^2, so y = |omega| h: the
// torque on it is -c omega - T omega / |omega|. f0: smooth_coulomb.cl, eps = velocity h.
#include "energies/contact/smooth_coulomb.cl"
#include "energies/body/spin.h"

static inline real spin_turned(const real3* x, const real3* x0) {
  real sum = 0;
  for (int k = 0; k < 3; ++k) sum += dot(x[k] - x0[k], x[k] - x0[k]);
  return sqrt(0.5 * sum);
}

static inline real spin_energy(const Spin p, const real3* x, const real3* x0, const real h) {
  const real y = spin_turned(x, x0);
  return 0.5 * p.drag / h * y * y + (p.torque > 0 ? p.torque * smooth_coulomb(y, p.velocity * h) : 0);
}

// (dE/dy) / y [N m]
static inline real spin_slope_over(const Spin* p, const real y, const real h) {
  return p->drag / h + (p->torque > 0 ? p->torque * smooth_coulomb_slope_over(y, p->velocity * h) : 0);
}

static inline void spin_gradient(const Spin p, const real3* x, const real3* x0, const real h, real3* g) {
  const real slope = spin_slope_over(&p, spin_turned(x, x0), h);
  for (int k = 0; k < 3; ++k) g[k] = 0.5 * slope * (x[k] - x0[k]);
}

static inline void spin_hessian(const Spin p, const real3* x, const real3* x0, const real h, real* H) {
  const real y = spin_turned(x, x0), across = 0.5 * spin_slope_over(&p, y, h);
  const real less = p.torque > 0 ? 0.25 * p.torque * smooth_coulomb_less_along(y, p.velocity * h) : 0;
  real d[9];
  for (int k = 0; k < 3; ++k) vstore3(x[k] - x0[k], k, d);
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) H[9 * i + j] = (i == j ? across : 0) - less * d[i] * d[j];
}

#define TERM spin
#define PARAMS Spin
#define STENCIL 3
#include "energies/assemble.cl"
