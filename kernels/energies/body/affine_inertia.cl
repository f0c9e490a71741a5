// Inertia of an affine body: E = sum_ab M_ab (x_a - x~_a).(x_b - x~_b) / (2 h^2), a, b in (p, a1, a2, a3)   [J]
// Lan et al. 2022, "Affine Body Dynamics". x0 holds the predicted nodes x~ here.
#include "energies/body/inertia.h"
#include "shared/real.h"

static inline real affine_mass(const AffineInertia p, int a, int b) {
  const int i = min(a, b), j = max(a, b);
  return p.mass[4 * i - i * (i + 1) / 2 + j];
}

static inline void affine_inertia_gradient(const AffineInertia p, const real3* x, const real3* x0, const real h,
                                           real3* g) {
  for (int a = 0; a < 4; ++a) {
    g[a] = (real3)(0);
    for (int b = 0; b < 4; ++b) g[a] += affine_mass(p, a, b) / (h * h) * (x[b] - x0[b]);
  }
}

static inline real affine_inertia_energy(const AffineInertia p, const real3* x, const real3* x0, const real h) {
  real3 g[4];
  affine_inertia_gradient(p, x, x0, h, g);
  real energy = 0;
  for (int a = 0; a < 4; ++a) energy += dot(g[a], x[a] - x0[a]) / 2;
  return energy;
}

static inline void affine_inertia_hessian(const AffineInertia p, const real3* x, const real3* x0, const real h,
                                          real* H) {
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) H[12 * i + j] = i % 3 == j % 3 ? affine_mass(p, i / 3, j / 3) / (h * h) : 0;
}

#define TERM affine_inertia
#define PARAMS AffineInertia
#define STENCIL 4
#include "energies/assemble.cl"
