// Where nodes and what they carry come to along a direction: x + step d
#ifndef PVG_SOLVE_MOVED_CL
#define PVG_SOLVE_MOVED_CL
#include "shared/real.h"
#include "solve/site.h"

static inline real3 moved_node(const uint i, const real step, global const real* restrict x,
                               global const real* restrict direction) {
  return vload3(i, x) + step * vload3(i, direction);
}

static inline real3 moved_site(const Site s, const real step, global const real* restrict x,
                               global const real* restrict direction) {
  real3 sum = s.weight[0] * moved_node(s.node[0], step, x, direction);
  for (int k = 1; k < 4; ++k)
    if (s.weight[k] != 0) sum += s.weight[k] * moved_node(s.node[k], step, x, direction);
  return sum;
}

#endif
