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

static inline void stable_neo_hookean_4_hessian(const StableNeoHookean4 p, const real3* x, const real3* x0,
                                                const real h, global real* H) {
  real3 b[4];
  tetrahedron_4_gradients(p.rest_inverse, b);
  for (int k = 0; k < 144; ++k) H[k] = 0;
  isotropic_add_hessian(stable_neo_hookean_hessian(tetrahedron_deformation(4, x, b), p.mu, p.lambda), p.volume, 4, b,
                        H);
  mirror_upper_in_place(12, H);
}

#define TERM stable_neo_hookean_4
#define PARAMS StableNeoHookean4
#define STENCIL 4
#define HESSIAN_IN_PLACE
#include "energies/assemble.cl"
