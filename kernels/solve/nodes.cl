// Between nodes and sites, and the vector operations of a time step. Per-world scalars are arrays over worlds, so that
// the bits of one world do not depend on its companions.
#include "shared/real.h"
#include "solve/moved.cl"
#include "solve/product_of_four.cl"
#include "solve/gather_two.cl"
#include "solve/value_at_site.cl"

// node: [n_nodes x 3];  value: [n_sites x 3] = sum_k weight_k node_k
kernel void nodes_to_sites(const uint n, global const Site* restrict sites, global const real* restrict node,
                           global real* restrict value) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3(value_at_site(sites + i, node), i, value);
}

// rows = H d of contact and of friction, whose elements have four sites; both kinds in one launch.
// n: elements of both;  n_first: of the first kind, whose 12 x 12 blocks are first_blocks;  element_sites: [n x 4]
// d: [n_nodes x 3];  rows: from row first_row on
kernel void product_of_contacts(const uint n, const uint n_first, global const uint* restrict element_sites,
                                global const Site* restrict sites, global const real* restrict first_blocks,
                                global const real* restrict second_blocks, global const real* restrict direction,
                                const uint first_row, global real* restrict rows) {
  const uint e = get_global_id(0);
  if (e >= n) return;
  real d[12];
  for (int s = 0; s < 4; ++s) {
    const real3 v = value_at_site(sites + element_sites[4 * e + s], direction);
    d[3 * s] = v.x;
    d[3 * s + 1] = v.y;
    d[3 * s + 2] = v.z;
  }
  product_of_four(e < n_first ? first_blocks + (size_t)e * 144 : second_blocks + (size_t)(e - n_first) * 144, d,
                  rows + (size_t)(first_row + e * 4) * 3);
}

// node[i] (+)= sum over its entries of weight x row; rows lie in a fixed order, so the sum has the same bits every time.
// offset: [n + 1] into row, weight;  rows: [n_rows x 3];  is_fixed nodes get zero
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void gather_rows(
    const uint n, global const uint* restrict offset, global const uint* restrict row,
    global const real* restrict weight, global const uint* restrict is_fixed, global const real* restrict rows,
    const uint accumulate, global real* restrict node) {
  local LongLists long_lists;
  const uint i = get_global_id(0), begin = get_group_id(0) * ITEMS;
  const RowLists lists = {offset, row, weight, rows};
  if (i < n) {
    const real3 sum = accumulate ? vload3(i, node) : (real3)(0);
    vstore3(is_fixed[i] ? sum : add_short_list(&lists, i, sum), i, node);
  }
  add_long_lists(&lists, begin, min(n, begin + ITEMS), is_fixed, node, &long_lists);
}

// The sums of two lists, and what conjugate gradients begin with: see gather_two_of_group.
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void gather_two_lists(
    const uint n, global const uint* restrict first_offset, global const uint* restrict first_row,
    global const real* restrict first_weight, global const uint* restrict second_offset,
    global const uint* restrict second_row, global const real* restrict second_weight,
    global const uint* restrict is_fixed, global const real* restrict rows, global real* restrict node,
    global real* restrict dx, global real* restrict residual) {
  local LongLists long_lists;
  const RowLists lists = {first_offset, first_row, first_weight, rows};
  const RowLists second = {second_offset, second_row, second_weight, rows};
  gather_two_of_group(n, &lists, &second, is_fixed, node, dx, residual, &long_lists);
}

// the position that inertia alone would lead to: x~ = x + h v + h^2 g    [m]
static inline real3 predicted_node(const uint i, global const real* restrict x, global const real* restrict v,
                                   global const real* restrict gravity, global const uint* restrict is_fixed,
                                   const real h) {
  const real3 xi = vload3(i, x);
  return is_fixed[i] ? xi : xi + h * vload3(i, v) + h * h * vload3(i, gravity);
}

// A step begins at x: start = x, predicted = x~ from past_x and past_v, of nodes and of the sites that they carry.
// n: the more of the two;  all of nodes [n_nodes x 3], of sites [n_sites x 3]
kernel void begin_step(const uint n, const uint n_nodes, const uint n_sites, global const Site* restrict sites,
                       global const real* restrict x, global const real* restrict past_x,
                       global const real* restrict past_v, global const real* restrict gravity,
                       global const uint* restrict is_fixed, const real h, global real* restrict start,
                       global real* restrict start_sites, global real* restrict predicted,
                       global real* restrict predicted_sites) {
  const uint i = get_global_id(0);
  if (i < n_nodes) {
    vstore3(vload3(i, x), i, start);
    vstore3(predicted_node(i, past_x, past_v, gravity, is_fixed, h), i, predicted);
  }
  if (i >= n_sites) return;
  vstore3(value_at_site(sites + i, x), i, start_sites);
  const Site s = sites[i];
  real3 sum = s.weight[0] * predicted_node(s.node[0], past_x, past_v, gravity, is_fixed, h);
  for (int k = 1; k < 4; ++k)
    if (s.weight[k] != 0) sum += s.weight[k] * predicted_node(s.node[k], past_x, past_v, gravity, is_fixed, h);
  vstore3(sum, i, predicted_sites);
}

// node[nodes[i]] = values[i];  n: of these nodes;  values: [n x 3]
kernel void place_nodes(const uint n, global const uint* restrict nodes, global const real* restrict values,
                        global real* restrict node) {
  const uint i = get_global_id(0);
  if (i < n) vstore3(vload3(i, values), nodes[i], node);
}

// What a second-order backward difference takes for the past: (4 a - b) / 3, a now and b one step before    [n x 3]
kernel void backward_difference(const uint n, global const real* restrict now, global const real* restrict before,
                                global real* restrict past) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3((4 * vload3(i, now) - vload3(i, before)) / 3, i, past);
}

// trial = x + step[world] direction, of nodes and of the sites that they carry.  n: the more of the two
kernel void move_along(const uint n, const uint n_nodes, const uint n_sites, global const uint* restrict world,
                       global const Site* restrict sites, global const real* restrict step,
                       global const real* restrict x, global const real* restrict direction,
                       global real* restrict trial, global real* restrict trial_sites) {
  const uint i = get_global_id(0);
  if (i < n_nodes) vstore3(moved_node(i, step[world[i]], x, direction), i, trial);
  if (i < n_sites) vstore3(moved_site(sites[i], step[world[sites[i].node[0]]], x, direction), i, trial_sites);
}

// Half the step of a world whose energy rose, but for a part `rounding` of it
static inline real halved_where_rising(const uint w, global const uint* restrict is_active,
                                       global const real* restrict before, global const real* restrict after,
                                       const real rounding, global const real* restrict step) {
  const bool falls = after[w] <= before[w] + rounding * fabs(before[w]);
  return is_active[w] && !falls ? step[w] / 2 : step[w];
}

// The same with the steps of active worlds whose energy rose halved.
// n: as above, or n_worlds if that is more;  before, after: energies [n_worlds, J];  halved: [n_worlds] gets these steps
kernel void halve_and_move(const uint n, const uint n_nodes, const uint n_sites, const uint n_worlds,
                           global const uint* restrict world, global const Site* restrict sites,
                           global const uint* restrict is_active, global const real* restrict before,
                           global const real* restrict after, const real rounding, global const real* restrict step,
                           global const real* restrict x, global const real* restrict direction,
                           global real* restrict halved, global real* restrict trial,
                           global real* restrict trial_sites) {
  const uint i = get_global_id(0);
  if (i < n_worlds) halved[i] = halved_where_rising(i, is_active, before, after, rounding, step);
  if (i < n_nodes) {
    const real own = halved_where_rising(world[i], is_active, before, after, rounding, step);
    vstore3(moved_node(i, own, x, direction), i, trial);
  }
  if (i < n_sites) {
    const real own = halved_where_rising(world[sites[i].node[0]], is_active, before, after, rounding, step);
    vstore3(moved_site(sites[i], own, x, direction), i, trial_sites);
  }
}

// A step ends at x: v = (x - from) / h, before = start    [n x 3]
kernel void end_step(const uint n, global const real* restrict x, global const real* restrict from,
                     global const real* restrict start, const real h, global real* restrict v,
                     global real* restrict before) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3((vload3(i, x) - vload3(i, from)) / h, i, v);
  vstore3(vload3(i, start), i, before);
}
