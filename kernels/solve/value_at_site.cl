// What nodes carry to a site: sum_k weight_k node_k
#ifndef PVG_SOLVE_VALUE_AT_SITE_CL
#define PVG_SOLVE_VALUE_AT_SITE_CL
#include "shared/real.h"
#include "solve/site.h"

// node: [n_nodes x 3]
static inline real3 value_at_site(global const Site* restrict site, global const real* restrict node) {
  const Site s = *site;
  real3 sum = s.weight[0] * vload3(s.node[0], node);
  for (int k = 1; k < 4; ++k)
    if (s.weight[k] != 0) sum += s.weight[k] * vload3(s.node[k], node);
  return sum;
}

#endif
