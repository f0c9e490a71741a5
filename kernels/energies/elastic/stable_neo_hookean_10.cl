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

// of the n_elements <= N_LANES elements from p on
static inline void stable_neo_hookean_10_hessian_of_lanes(const uint n_elements, global const StableNeoHookean10* p,
                                                      global const real* x, global real* H) {
  lanes at[10][3], rest_inverse[9], volume, mu, lambda;
  for (int s = 0; s < 10; ++s)
    for (int k = 0; k < 3; ++k) SET_LANES(at[s][k], n_elements, x[3 * p[e].site[s] + k]);
  for (int k = 0; k < 9; ++k) SET_LANES(rest_inverse[k], n_elements, p[e].rest_inverse[k]);
  SET_LANES(volume, n_elements, p[e].volume);
  SET_LANES(mu, n_elements, p[e].mu);
  SET_LANES(lambda, n_elements, p[e].lambda);
  lanes l[4][3], b[10][3], f[3][3];
  UPPER_SUM(sum, 10, H);
  lanes_tetrahedron_4_gradients(rest_inverse, l);
  clear_upper(10, sum);
  for (int q = 0; q < 4; ++q) {
    lanes_tetrahedron_10_gradients(l, q, b);
    lanes_tetrahedron_deformation(10, at, b, f);
    IsotropicHessian hessian;
    stable_neo_hookean_hessian(f, mu, lambda, &hessian);
    isotropic_add_hessian(&hessian, 0.25 * volume, 10, b, sum);
  }
  store_upper(10, n_elements, sum, H);
}

#define TERM stable_neo_hookean_10
#define PARAMS StableNeoHookean10
#define STENCIL 10
#define HESSIAN_OF_LANES
#include "energies/assemble.cl"
