// The Hessian of friction for Newton's method. The energy mu lambda f0(|u|) of friction.cl bends within eps, some
// micrometres, and is nearly straight beyond. Its exact second derivative knows nothing of a bend that lies ahead, so that
// steps lead far past it and a line search has to halve them. Here the pull sigma is an unknown of its own, of
//   q(|u|) sigma - u = 0,    q(y) = y / f0'(y)
// linearised in both: after a step from u to u + du
//   sigma' = (u + du - q' sigma (u . du) / |u|) / q,    cut to |sigma'| <= 1
// and the Hessian is made with sigma' and the new u. A contact that slid one way and now would slide the other is then
// stiff; at the minimum sigma is the pull itself and the Hessian exact.
// Chan, Golub, Mulet 1999, "A nonlinear primal-dual method for total variation-based image restoration"; cut as by
// Hintermueller, Stadler 2006.
#ifndef PVG_ENERGIES_PRIMAL_DUAL_FRICTION_CL
#define PVG_ENERGIES_PRIMAL_DUAL_FRICTION_CL
#include "energies/contact/friction.cl"

// sigma' [-];  u: sliding now [m]
static inline real3 next_pull(const Friction* p, const FrictionDual* last, const real3 u, const real h) {
  const real3 before = vload3(0, last->sliding);
  const real y = length(before), eps = p->friction_velocity * h;
  const real turn = y > 0 ? smooth_coulomb_ratio_slope(y, eps) * dot(before, u - before) / y : 0;
  const real3 pull = smooth_coulomb_slope_over(y, eps) * (u - turn * vload3(0, last->pull));
  return pull / fmax(1.0, length(pull));
}

// begins: Newton's method does, and the Hessian is exact.  dual: [n];  blocks: [n x 144]
static inline void primal_dual_friction_hessian_of(const uint e, global const Friction* restrict params,
                                                   global const real* restrict x, global const real* restrict x0,
                                                   const real h, const uint begins, global FrictionDual* restrict dual,
                                                   global real* restrict blocks) {
  const Friction p = params[e];
  real3 xe[4], x0e[4];
  for (int s = 0; s < 4; ++s) {
    xe[s] = vload3(p.site[s], x);
    x0e[s] = vload3(p.site[s], x0);
  }
  const real3 u = tangential_sliding(&p, xe, x0e);
  const FrictionDual last = dual[e];
  const real3 pull = begins ? friction_pull(&p, u, h) : next_pull(&p, &last, u, h);
  real H[144];
  friction_hessian_of_pull(&p, u, pull, h, H);
  for (int k = 0; k < 144; ++k) blocks[(size_t)e * 144 + k] = H[k];
  FrictionDual now;
  vstore3(u, 0, now.sliding);
  vstore3(pull, 0, now.pull);
  dual[e] = now;
}

#endif
