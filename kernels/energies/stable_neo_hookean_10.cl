// Stable neo-Hookean tetrahedron with 10 nodes:  E = V/4 sum_q Psi(F_q),  F_q = sum_a x_a (grad N_a)^T at point q   [J]
// N_a = L_a (2 L_a - 1) of a corner, 4 L_a L_b of the midpoint of edge ab; the 4-point rule is exact to second degree
// and leaves no zero-energy mode (24 strains for 24 deformations). Straight sides at rest make grad L_a constant.
// The density and its source: stable_neo_hookean_density.cl.
#include "energies/stable_neo_hookean_10.h"
#include "energies/stable_neo_hookean_density.cl"

// barycentric coordinates of the quadrature points: (5 + 3 sqrt 5) / 20 toward one corner, (5 - sqrt 5) / 20 else
#define STABLE_NEO_HOOKEAN_10_NEAR 0.58541019662496845446
#define STABLE_NEO_HOOKEAN_10_FAR 0.13819660112501051518

// b: gradients of the 10 shape functions at quadrature point q [1/m]
void stable_neo_hookean_10_gradients(const StableNeoHookean10 p, const int q, real3 b[10]) {
  real3 l[4];
  for (int a = 0; a < 3; ++a) l[a + 1] = vload3(a, p.rest_inverse);
  l[0] = -(l[1] + l[2] + l[3]);
  real at[4];
  for (int a = 0; a < 4; ++a) at[a] = a == q ? STABLE_NEO_HOOKEAN_10_NEAR : STABLE_NEO_HOOKEAN_10_FAR;
  for (int a = 0; a < 4; ++a) b[a] = (4 * at[a] - 1) * l[a];
  b[4] = 4 * (at[0] * l[1] + at[1] * l[0]);
  b[5] = 4 * (at[1] * l[2] + at[2] * l[1]);
  b[6] = 4 * (at[0] * l[2] + at[2] * l[0]);
  b[7] = 4 * (at[0] * l[3] + at[3] * l[0]);
  b[8] = 4 * (at[1] * l[3] + at[3] * l[1]);
  b[9] = 4 * (at[2] * l[3] + at[3] * l[2]);
}

Mat3 stable_neo_hookean_10_deformation(const real3* x, const real3 b[10]) {
  Mat3 f = mat3_outer(x[0], b[0]);
  for (int a = 1; a < 10; ++a) f = mat3_plus(f, mat3_outer(x[a], b[a]));
  return f;
}

real stable_neo_hookean_10_energy(const StableNeoHookean10 p, const real3* x, const real3* x0, const real h) {
  // the corners may fold over while every quadrature point is still upright
  if (!(dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])) > 0)) return INFINITY;
  real sum = 0;
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    stable_neo_hookean_10_gradients(p, q, b);
    sum += stable_neo_hookean_density(stable_neo_hookean_10_deformation(x, b), p.mu, p.lambda);
  }
  return 0.25 * p.volume * sum;
}

void stable_neo_hookean_10_gradient(const StableNeoHookean10 p, const real3* x, const real3* x0, const real h,
                                    real3* g) {
  for (int a = 0; a < 10; ++a) g[a] = (real3)(0, 0, 0);
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    stable_neo_hookean_10_gradients(p, q, b);
    const Mat3 stress = mat3_scaled(stable_neo_hookean_stress(stable_neo_hookean_10_deformation(x, b), p.mu, p.lambda),
                                    0.25 * p.volume);
    for (int a = 0; a < 10; ++a) g[a] += mat3_times(stress, b[a]);
  }
}

void stable_neo_hookean_10_hessian(const StableNeoHookean10 p, const real3* x, const real3* x0, const real h, real* H) {
  for (int k = 0; k < 900; ++k) H[k] = 0;
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    stable_neo_hookean_10_gradients(p, q, b);
    isotropic_add_hessian(stable_neo_hookean_hessian(stable_neo_hookean_10_deformation(x, b), p.mu, p.lambda),
                          0.25 * p.volume, 10, b, H);
  }
  mirror_upper(30, H);
}

#define TERM stable_neo_hookean_10
#define PARAMS StableNeoHookean10
#define STENCIL 10
#include "energies/assemble.cl"
