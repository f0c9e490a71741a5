// Stable neo-Hookean tetrahedron with 10 nodes:  E = V/4 sum_q Psi(F_q),  F_q = sum_a x_a (grad N_a)^T at point q   [J]
// The 4-point rule of tetrahedron.cl leaves no zero-energy mode (24 strains for 24 deformations).
// The density and its source: stable_neo_hookean_density.cl.
#include "energies/elastic/stable_neo_hookean_10.h"
#include "energies/elastic/stable_neo_hookean_density.cl"
#include "energies/elastic/tetrahedron.cl"

static inline real stable_neo_hookean_10_energy(const StableNeoHookean10 p, const real3* x, const real3* x0,
                                                const real h) {
  // the corners may fold over while every quadrature point is still upright
  if (!(dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])) > 0)) return INFINITY;
  real sum = 0;
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    tetrahedron_10_gradients(p.rest_inverse, q, b);
    sum += stable_neo_hookean_density(tetrahedron_deformation(10, x, b), p.mu, p.lambda);
  }
  return 0.25 * p.volume * sum;
}

static inline void stable_neo_hookean_10_gradient(const StableNeoHookean10 p, const real3* x, const real3* x0,
                                                  const real h, real3* g) {
  for (int a = 0; a < 10; ++a) g[a] = (real3)(0, 0, 0);
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    tetrahedron_10_gradients(p.rest_inverse, q, b);
    const Mat3 stress =
        mat3_scaled(stable_neo_hookean_stress(tetrahedron_deformation(10, x, b), p.mu, p.lambda), 0.25 * p.volume);
    for (int a = 0; a < 10; ++a) g[a] += mat3_times(stress, b[a]);
  }
}

static inline void stable_neo_hookean_10_hessian(const StableNeoHookean10 p, const real3* x, const real3* x0,
                                                 const real h, global real* H) {
  for (int k = 0; k < 900; ++k) H[k] = 0;
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    tetrahedron_10_gradients(p.rest_inverse, q, b);
    isotropic_add_hessian(stable_neo_hookean_hessian(tetrahedron_deformation(10, x, b), p.mu, p.lambda),
                          0.25 * p.volume, 10, b, H);
  }
  mirror_upper_in_place(30, H);
}

#define TERM stable_neo_hookean_10
#define PARAMS StableNeoHookean10
#define STENCIL 10
#define HESSIAN_IN_PLACE
#include "energies/assemble.cl"
