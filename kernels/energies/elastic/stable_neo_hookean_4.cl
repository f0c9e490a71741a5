// Stable neo-Hookean tetrahedron with 4 nodes:  E = V Psi(F),  F = sum_a x_a (grad L_a)^T  constant in the element  [J]
// The density and its source: stable_neo_hookean_density.cl.
#include "energies/elastic/stable_neo_hookean_4.h"
#include "energies/elastic/stable_neo_hookean_density.cl"
#include "energies/elastic/tetrahedron.cl"

static inline real stable_neo_hookean_4_energy(const StableNeoHookean4 p, const real3* x, const real3* x0,
                                               const real h) {
  real3 b[4];
  tetrahedron_4_gradients(p.rest_inverse, b);
  return p.volume * stable_neo_hookean_density(tetrahedron_deformation(4, x, b), p.mu, p.lambda);
}

static inline void stable_neo_hookean_4_gradient(const StableNeoHookean4 p, const real3* x, const real3* x0,
                                                 const real h, real3* g) {
  real3 b[4];
  tetrahedron_4_gradients(p.rest_inverse, b);
  const Mat3 stress = stable_neo_hookean_stress(tetrahedron_deformation(4, x, b), p.mu, p.lambda);
  for (int a = 0; a < 4; ++a) g[a] = p.volume * mat3_times(stress, b[a]);
}

// of the n_elements <= N_LANES elements from p on
static inline void stable_neo_hookean_4_hessian_of_lanes(const uint n_elements, global const StableNeoHookean4* p,
                                                      global const real* x, global real* H) {
  lanes at[4][3], rest_inverse[9], volume, mu, lambda;
  for (int s = 0; s < 4; ++s)
    for (int k = 0; k < 3; ++k) SET_LANES(at[s][k], n_elements, x[3 * p[e].site[s] + k]);
  for (int k = 0; k < 9; ++k) SET_LANES(rest_inverse[k], n_elements, p[e].rest_inverse[k]);
  SET_LANES(volume, n_elements, p[e].volume);
  SET_LANES(mu, n_elements, p[e].mu);
  SET_LANES(lambda, n_elements, p[e].lambda);
  lanes b[4][3], f[3][3];
  UPPER_SUM(sum, 4, H);
  lanes_tetrahedron_4_gradients(rest_inverse, b);
  lanes_tetrahedron_deformation(4, at, b, f);
  IsotropicHessian hessian;
  stable_neo_hookean_hessian(f, mu, lambda, &hessian);
  clear_upper(4, sum);
  isotropic_add_hessian(&hessian, volume, 4, b, sum);
  store_upper(4, n_elements, sum, H);
}

#define TERM stable_neo_hookean_4
#define PARAMS StableNeoHookean4
#define STENCIL 4
#define HESSIAN_OF_LANES
#include "energies/assemble.cl"
