// node[i] = the sum over the entries of one list, then over those of another, as by two calls of gather_rows; and what
// conjugate gradients begin with where this is the gradient, as by cg_start: dx = 0, residual = -node
#ifndef PVG_SOLVE_GATHER_TWO_CL
#define PVG_SOLVE_GATHER_TWO_CL
#include "solve/row_lists.cl"

// By a work-group for its 64 nodes.  n: nodes;  node, dx, residual: [n x 3];  is_fixed nodes get zero
static inline void gather_two_of_group(const uint n, const RowLists* lists, const RowLists* second,
                                       global const uint* restrict is_fixed, global real* restrict node,
                                       global real* restrict dx, global real* restrict residual,
                                       local LongLists* long_lists) {
  const uint i = get_global_id(0), begin = get_group_id(0) * ITEMS, end = min(n, begin + ITEMS);
  if (i < n) {
    const real3 sum = is_fixed[i] ? (real3)(0) : add_short_list(lists, i, (real3)(0));
    vstore3(is_fixed[i] ? sum : add_short_list(second, i, sum), i, node);
  }
  add_long_lists(lists, begin, end, is_fixed, node, long_lists);
  add_long_lists(second, begin, end, is_fixed, node, long_lists);
  barrier(CLK_GLOBAL_MEM_FENCE);  // work-items have added to nodes of others
  if (i >= n) return;
  vstore3((real3)(0), i, dx);
  vstore3(-vload3(i, node), i, residual);
}

#endif
