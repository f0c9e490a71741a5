// Smoothed Coulomb friction of a lagged contact: E = mu lambda f0(|u|) + chi lambda s^2 / (2 h)      [J]
//   u = (I - n n^T) sum_i c_i (x_i - x0_i) + e        sliding within the step, plus the anchor's part [m]
//   f0: smooth_coulomb.cl, eps = epsilon_v h
//   s = n . sum_i c_i (x_i - x0_i)                    parting within the step [m]: N = lambda (1 - chi s / h)
// Li et al. 2020, "Incremental Potential Contact"; the damping of the approach is that of Hunt and Crossley 1975. c, n,
// lambda are lagged, so the exact Hessian is positive semi-definite; Newton's method takes that of
// primal_dual_friction.cl. e is what a sticking contact carries from step to step
// (host/physics/contact/friction_anchors.hpp). Stencil: 4 sites.
#ifndef PVG_ENERGIES_FRICTION_CL
#define PVG_ENERGIES_FRICTION_CL
#include "energies/contact/friction.h"
#include "energies/contact/smooth_coulomb.cl"

// u [m]
static inline real3 friction_sliding(const Friction* p, const real3* x, const real3* x0) {
  const real3 n = vload3(0, p->normal);
  real3 u = (real3)(0.0);
  for (int i = 0; i < 4; ++i) u += p->coefficient[i] * (x[i] - x0[i]);
  return u - dot(u, n) * n + vload3(0, p->anchor);
}

// u without what rounding, or the anchor, has along the normal
static inline real3 tangential_sliding(const Friction* p, const real3* x, const real3* x0) {
  const real3 n = vload3(0, p->normal), u = friction_sliding(p, x, x0);
  return u - dot(u, n) * n;
}

// s [m]
static inline real friction_parting(const Friction* p, const real3* x, const real3* x0) {
  real3 u = (real3)(0.0);
  for (int i = 0; i < 4; ++i) u += p->coefficient[i] * (x[i] - x0[i]);
  return dot(u, vload3(0, p->normal));
}

// chi lambda / h [N/m]
static inline real friction_dissipation(const Friction* p, const real h) {
  return p->dissipation * p->normal_force / h;
}

static inline real friction_energy(const Friction p, const real3* x, const real3* x0, const real h) {
  const real s = p.dissipation > 0 ? friction_parting(&p, x, x0) : 0;
  const real y = length(friction_sliding(&p, x, x0)), eps = p.friction_velocity * h;
  return p.friction * p.normal_force * smooth_coulomb(y, eps) + 0.5 * friction_dissipation(&p, h) * s * s;
}

// f0'(|u|) u / |u|: what pulls against the sliding, of mu lambda
static inline real3 friction_pull(const Friction* p, const real3 u, const real h) {
  return smooth_coulomb_slope_over(length(u), p->friction_velocity * h) * u;
}

static inline void friction_gradient(const Friction p, const real3* x, const real3* x0, const real h, real3* g) {
  const real3 n = vload3(0, p.normal), pull = friction_pull(&p, tangential_sliding(&p, x, x0), h);
  const real along = p.dissipation > 0 ? friction_dissipation(&p, h) * friction_parting(&p, x, x0) : 0;
  for (int i = 0; i < 4; ++i) g[i] = p.coefficient[i] * (p.friction * p.normal_force * pull + along * n);
}

// With sigma in place of the pull: of blocks c_i c_j [a (P - q' (sigma u^T + u sigma^T) / (2 |u|)) + chi lambda / h n n^T],
//   P = I - n n^T,   a = mu lambda f0' / |u|,   q = |u| / f0'
// Exact for sigma = friction_pull(u), positive semi-definite for all |sigma| <= 1, since q' <= 1.
static inline void friction_hessian_of_pull(const Friction* p, const real3 u3, const real3 sigma3, const real h, real* H) {
  const real3 n3 = vload3(0, p->normal);
  const real y = length(u3), eps = p->friction_velocity * h;
  const real across = p->friction * p->normal_force * smooth_coulomb_slope_over(y, eps);
  const real less = y > 0 ? across * smooth_coulomb_ratio_slope(y, eps) / (2 * y) : 0;
  const real along = friction_dissipation(p, h);
  const real n[3] = {n3.x, n3.y, n3.z}, u[3] = {u3.x, u3.y, u3.z}, sigma[3] = {sigma3.x, sigma3.y, sigma3.z};
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      const int a = i % 3, b = j % 3;
      const real projector = (a == b ? 1 : 0) - n[a] * n[b];
      H[12 * i + j] = p->coefficient[i / 3] * p->coefficient[j / 3] *
                      (across * projector - less * (sigma[a] * u[b] + u[a] * sigma[b]) + along * n[a] * n[b]);
    }
}

static inline void friction_hessian(const Friction p, const real3* x, const real3* x0, const real h, real* H) {
  const real3 u = tangential_sliding(&p, x, x0);
  friction_hessian_of_pull(&p, u, friction_pull(&p, u, h), h, H);
}

#define TERM friction
#define PARAMS Friction
#define STENCIL 4
#define HESSIAN_WHOLE
#include "energies/assemble.cl"

// What the second body exerts on the first by friction. force: [n x 3, N]
kernel void friction_force(const uint n, global const Friction* restrict params, global const real* restrict x,
                           global const real* restrict x0, const real h, global real* restrict force) {
  const uint e = get_global_id(0);
  if (e >= n) return;
  const Friction p = params[e];
  real3 xe[4], x0e[4], g[4];
  for (int s = 0; s < 4; ++s) {
    xe[s] = vload3(p.site[s], x);
    x0e[s] = vload3(p.site[s], x0);
  }
  friction_gradient(p, xe, x0e, h, g);
  // the first primitive: a point, or the first two sites
  vstore3(p.kind == 1u ? -(g[0] + g[1]) : -g[0], e, force);
}

// u / eps cut to length 1: how far each contact is strained at the end of a step. strain: [n x 3]
kernel void friction_strain(const uint n, global const Friction* restrict params, global const real* restrict x,
                            global const real* restrict x0, const real h, global real* restrict strain) {
  const uint e = get_global_id(0);
  if (e >= n) return;
  const Friction p = params[e];
  real3 xe[4], x0e[4];
  for (int s = 0; s < 4; ++s) {
    xe[s] = vload3(p.site[s], x);
    x0e[s] = vload3(p.site[s], x0);
  }
  const real3 u = friction_sliding(&p, xe, x0e) / (p.friction_velocity * h);
  vstore3(u / fmax(1.0, length(u)), e, strain);
}

#endif
