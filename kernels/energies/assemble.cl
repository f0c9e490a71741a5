// Makes the kernels of one energy term from its functions; one work-item per element. A term acts on sites (points or
// directions carried by a few nodes), so it is written once for every kind of body.
//   in:  TERM, PARAMS (whose first member is `u32 site[STENCIL]`), STENCIL, and the functions
//          real TERM_energy  (PARAMS p, const real3* x, const real3* x0, real h)                       [J]
//          void TERM_gradient(PARAMS p, const real3* x, const real3* x0, real h, real3* g)             [N]
//          void TERM_hessian (PARAMS p, const real3* x, const real3* x0, real h, real* H)              [N/m]
//        x: site positions now, x0: at the start of the step [STENCIL, m], h: time step [s];
//        H: row-major (3 STENCIL)^2, positive semi-definite. What lies below its diagonal of 3 x 3 blocks is not read.
//        With HESSIAN_IN_PLACE it is `global real* H`, the blocks on and above the diagonal alone (upper_blocks.cl), where
//        they belong: a private array of 30 x 30 numbers takes 7,200 bytes of memory for each work-item.
//        With HESSIAN_WHOLE, as of contact and friction, all of it is read and kept.
//        With HESSIAN_OF_LANES there is, for as many elements at once as shared/lanes.h says,
//          void TERM_hessian_of_lanes(uint n_elements, global const PARAMS* p, global const real* x, global real* H)
//   out: kernels TERM_energy_all, TERM_gradient_all, TERM_hessian_all, TERM_product_all; what they do for one element is
//        TERM_energy_of and TERM_derivatives_of, which are all there is where TERM_FUNCTIONS_ONLY is defined
//        (host/physics/energies/small_terms.cpp)
// Rows: each element writes STENCIL rows of its own, gathered to the nodes later in a fixed order (solve/nodes.cl).
#include "energies/upper_blocks.cl"
#include "shared/real.h"
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#ifdef HESSIAN_WHOLE
#define HESSIAN_NUMBERS (9 * STENCIL * STENCIL)
#else
#define HESSIAN_NUMBERS (9 * STENCIL * (STENCIL + 1) / 2)
#endif

static inline void JOIN(TERM, _energy_of)(const uint e, global const PARAMS* restrict params,
                                          global const real* restrict x, global const real* restrict x0, const real h,
                                          const uint first, global real* restrict energy) {
  const PARAMS p = params[e];
  real3 xe[STENCIL], x0e[STENCIL];
  for (int s = 0; s < STENCIL; ++s) {
    xe[s] = vload3(p.site[s], x);
    x0e[s] = vload3(p.site[s], x0);
  }
  energy[first + e] = JOIN(TERM, _energy)(p, xe, x0e, h);
}

static inline void JOIN(TERM, _gradient_of)(const uint e, global const PARAMS* restrict params,
                                            global const real* restrict x, global const real* restrict x0, const real h,
                                            const uint first_row, global real* restrict rows) {
  const PARAMS p = params[e];
  real3 xe[STENCIL], x0e[STENCIL], g[STENCIL];
  for (int s = 0; s < STENCIL; ++s) {
    xe[s] = vload3(p.site[s], x);
    x0e[s] = vload3(p.site[s], x0);
  }
  JOIN(TERM, _gradient)(p, xe, x0e, h, g);
  for (int s = 0; s < STENCIL; ++s) vstore3(g[s], first_row + e * STENCIL + s, rows);
}

static inline void JOIN(TERM, _hessian_of)(const uint e, global const PARAMS* restrict params,
                                           global const real* restrict x, global const real* restrict x0, const real h,
                                           const uint first, global real* restrict blocks) {
  global real* out = blocks + first + (size_t)e * HESSIAN_NUMBERS;
#ifdef HESSIAN_OF_LANES
  JOIN(TERM, _hessian_of_lanes)(1, params + e, x, out);
#else
  const PARAMS p = params[e];
  real3 xe[STENCIL], x0e[STENCIL];
  for (int s = 0; s < STENCIL; ++s) {
    xe[s] = vload3(p.site[s], x);
    x0e[s] = vload3(p.site[s], x0);
  }
#ifdef HESSIAN_IN_PLACE
  JOIN(TERM, _hessian)(p, xe, x0e, h, out);
#else
  real H[9 * STENCIL * STENCIL];
  JOIN(TERM, _hessian)(p, xe, x0e, h, H);
#ifdef HESSIAN_WHOLE
  for (int k = 0; k < HESSIAN_NUMBERS; ++k) out[k] = H[k];
#else
  for (int i = 0; i < STENCIL; ++i)
    for (int j = i; j < STENCIL; ++j, out += 9)
      for (int k = 0; k < 9; ++k) out[k] = H[(3 * i + k / 3) * 3 * STENCIL + 3 * j + k % 3];
#endif
#endif
#endif
}

#ifndef TERM_FUNCTIONS_ONLY
// x, x0: sites [n_sites x 3, m];  energy: [n, J], from number `first` on
kernel void JOIN(TERM, _energy_all)(const uint n, global const PARAMS* restrict params, global const real* restrict x,
                                    global const real* restrict x0, const real h, const uint first,
                                    global real* restrict energy) {
  const uint e = get_global_id(0);
  if (e < n) JOIN(TERM, _energy_of)(e, params, x, x0, h, first, energy);
}

// rows: [n x STENCIL x 3, N], from row first_row on
kernel void JOIN(TERM, _gradient_all)(const uint n, global const PARAMS* restrict params, global const real* restrict x,
                                      global const real* restrict x0, const real h, const uint first_row,
                                      global real* restrict rows) {
  const uint e = get_global_id(0);
  if (e < n) JOIN(TERM, _gradient_of)(e, params, x, x0, h, first_row, rows);
}

// blocks: of elements begin .. begin + n - 1  [n_elements x HESSIAN_NUMBERS, N/m], from number `first` on
kernel void JOIN(TERM, _hessian_all)(const uint n, const uint begin, global const PARAMS* restrict params, global const real* restrict x,
                                     global const real* restrict x0, const real h, const uint first,
                                     global real* restrict blocks) {
#ifdef HESSIAN_OF_LANES
  // the first work-items of each group take all its elements
  const uint in_group = get_local_id(0) * N_LANES, e = get_group_id(0) * get_local_size(0) + in_group;
  if (in_group < get_local_size(0) && e < n)
    JOIN(TERM, _hessian_of_lanes)(min(n - e, (uint)N_LANES), params + begin + e, x,
                                  blocks + first + (size_t)(begin + e) * HESSIAN_NUMBERS);
#else
  const uint e = get_global_id(0);
  if (e < n) JOIN(TERM, _hessian_of)(begin + e, params, x, x0, h, first, blocks);
#endif
}

// rows = H d per element, blocks from number `first` on;  d: sites [n_sites x 3, m]
kernel void JOIN(TERM, _product_all)(const uint n, global const PARAMS* restrict params, const uint first,
                                     global const real* restrict blocks, global const real* restrict d,
                                     const uint first_row, global real* restrict rows) {
  const uint e = get_global_id(0);
  if (e >= n) return;
  real de[3 * STENCIL];
  for (int s = 0; s < STENCIL; ++s) {
    const real3 v = vload3(params[e].site[s], d);
    de[3 * s] = v.x;
    de[3 * s + 1] = v.y;
    de[3 * s + 2] = v.z;
  }
  global const real* H = blocks + first + (size_t)e * HESSIAN_NUMBERS;
  global real* out = rows + (size_t)(first_row + e * STENCIL) * 3;
  for (int i = 0; i < 3 * STENCIL; ++i) {
    real sum = 0;
    for (int j = 0; j < 3 * STENCIL; ++j)
#ifdef HESSIAN_WHOLE
      sum += H[i * 3 * STENCIL + j] * de[j];
#else
      sum += H[i / 3 <= j / 3 ? upper_block(STENCIL, i / 3, j / 3) + 3 * (i % 3) + j % 3
                              : upper_block(STENCIL, j / 3, i / 3) + 3 * (j % 3) + i % 3] * de[j];
#endif
    out[i] = sum;
  }
}
#endif
#undef TERM
#undef PARAMS
#undef STENCIL
#undef HESSIAN_NUMBERS
#undef HESSIAN_WHOLE
#undef HESSIAN_IN_PLACE
#undef HESSIAN_OF_LANES
#undef JOIN
#undef JOIN_
