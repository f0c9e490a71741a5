// Between nodes and sites, and the vector operations of a time step. Per-world scalars are arrays over worlds, so that
// the bits of one world do not depend on its companions.
#include "shared/real.h"
#include "solve/site.h"

// node: [n_nodes x 3];  value: [n_sites x 3] = sum_k weight_k node_k
kernel void nodes_to_sites(const uint n, global const Site* restrict sites, global const real* restrict node,
                           global real* restrict value) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Site s = sites[i];
  real3 sum = s.weight[0] * vload3(s.node[0], node);
  for (int k = 1; k < 4; ++k)
    if (s.weight[k] != 0) sum += s.weight[k] * vload3(s.node[k], node);
  vstore3(sum, i, value);
}

// node[i] (+)= sum over its entries of weight x row; rows lie in a fixed order, so the sum has the same bits every time.
// offset: [n + 1] into row, weight;  rows: [n_rows x 3];  is_fixed nodes get zero
kernel void gather_rows(const uint n, global const uint* restrict offset, global const uint* restrict row,
                        global const real* restrict weight, global const uint* restrict is_fixed,
                        global const real* restrict rows, const uint accumulate, global real* restrict node) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  real3 sum = accumulate ? vload3(i, node) : (real3)(0);
  if (!is_fixed[i])
    for (uint k = offset[i]; k < offset[i + 1]; ++k) sum += weight[k] * vload3(row[k], rows);
  vstore3(sum, i, node);
}

// the position that inertia alone would lead to: x~ = x + h v + h^2 g    [n x 3, m]
kernel void predict(const uint n, global const real* restrict x, global const real* restrict v,
                    global const real* restrict gravity, global const uint* restrict is_fixed, const real h,
                    global real* restrict predicted) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const real3 xi = vload3(i, x);
  vstore3(is_fixed[i] ? xi : xi + h * vload3(i, v) + h * h * vload3(i, gravity), i, predicted);
}

// What a second-order backward difference takes for the past: (4 a - b) / 3, a now and b one step before    [n x 3]
kernel void backward_difference(const uint n, global const real* restrict now, global const real* restrict before,
                                global real* restrict past) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3((4 * vload3(i, now) - vload3(i, before)) / 3, i, past);
}

// trial = x + step[world] direction
kernel void move_along(const uint n, global const uint* restrict world, global const real* restrict step,
                       global const real* restrict x, global const real* restrict direction,
                       global real* restrict trial) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3(vload3(i, x) + step[world[i]] * vload3(i, direction), i, trial);
}

// v = (x - x0) / h
kernel void velocity_from_positions(const uint n, global const real* restrict x, global const real* restrict x0,
                                    const real h, global real* restrict v) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3((vload3(i, x) - vload3(i, x0)) / h, i, v);
}
