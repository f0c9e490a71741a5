// Preconditioned conjugate gradients for H dx = -g, all worlds at once (Hestenes & Stiefel 1952):
//   alpha = r.z / p.Hp,  dx += alpha p,  r -= alpha Hp,  z = M^-1 r,  beta = (r.z)_new / r.z,  p = z + beta p
// A world that has converged keeps its dx: its alpha is zero.
#include "shared/real.h"

// dx = 0, r = -g
kernel void cg_start(const uint n, global const real* restrict gradient, global real* restrict dx,
                     global real* restrict residual) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3((real3)(0), i, dx);
  vstore3(-vload3(i, gradient), i, residual);
}

// rz, php: [n_worlds];  is_active: [n_worlds]
kernel void cg_advance(const uint n, global const uint* restrict world, global const uint* restrict is_active,
                       global const real* restrict rz, global const real* restrict php,
                       global const real* restrict direction, global const real* restrict product,
                       global real* restrict dx, global real* restrict residual) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint w = world[i];
  if (!is_active[w]) return;
  const real alpha = rz[w] / php[w];
  vstore3(vload3(i, dx) + alpha * vload3(i, direction), i, dx);
  vstore3(vload3(i, residual) - alpha * vload3(i, product), i, residual);
}

// p = z + (rz_new / rz_old) p;  rz_old = 0 starts with p = z
kernel void cg_turn(const uint n, global const uint* restrict world, global const uint* restrict is_active,
                    global const real* restrict rz_new, global const real* restrict rz_old,
                    global const real* restrict preconditioned, global real* restrict direction) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint w = world[i];
  if (!is_active[w]) {
    vstore3((real3)(0), i, direction);
    return;
  }
  const real beta = rz_old[w] > 0 ? rz_new[w] / rz_old[w] : 0;
  vstore3(vload3(i, preconditioned) + (beta != 0 ? beta * vload3(i, direction) : (real3)(0)), i, direction);
}
