// Stable neo-Hookean tetrahedron with 4 nodes:  E = V Psi(F),  F = sum_a x_a (grad L_a)^T  constant in the element  [J]
// L_a: barycentric coordinates of the rest shape. The density and its source: stable_neo_hookean_density.cl.
#include "energies/stable_neo_hookean_4.h"
#include "energies/stable_neo_hookean_density.cl"

void stable_neo_hookean_4_gradients(const StableNeoHookean4 p, real3 b[4]) {
  for (int a = 0; a < 3; ++a) b[a + 1] = vload3(a, p.rest_inverse);
  b[0] = -(b[1] + b[2] + b[3]);
}

Mat3 stable_neo_hookean_4_deformation(const real3* x, const real3 b[4]) {
  Mat3 f = mat3_outer(x[0], b[0]);
  for (int a = 1; a < 4; ++a) f = mat3_plus(f, mat3_outer(x[a], b[a]));
  return f;
}

real stable_neo_hookean_4_energy(const StableNeoHookean4 p, const real3* x, const real3* x0, const real h) {
  real3 b[4];
  stable_neo_hookean_4_gradients(p, b);
  return p.volume * stable_neo_hookean_density(stable_neo_hookean_4_deformation(x, b), p.mu, p.lambda);
}

void stable_neo_hookean_4_gradient(const StableNeoHookean4 p, const real3* x, const real3* x0, const real h, real3* g) {
  real3 b[4];
  stable_neo_hookean_4_gradients(p, b);
  const Mat3 stress = stable_neo_hookean_stress(stable_neo_hookean_4_deformation(x, b), p.mu, p.lambda);
  for (int a = 0; a < 4; ++a) g[a] = p.volume * mat3_times(stress, b[a]);
}

void stable_neo_hookean_4_hessian(const StableNeoHookean4 p, const real3* x, const real3* x0, const real h, real* H) {
  real3 b[4];
  stable_neo_hookean_4_gradients(p, b);
  for (int k = 0; k < 144; ++k) H[k] = 0;
  isotropic_add_hessian(stable_neo_hookean_hessian(stable_neo_hookean_4_deformation(x, b), p.mu, p.lambda), p.volume, 4,
                        b, H);
  mirror_upper(12, H);
}

#define TERM stable_neo_hookean_4
#define PARAMS StableNeoHookean4
#define STENCIL 4
#include "energies/assemble.cl"
