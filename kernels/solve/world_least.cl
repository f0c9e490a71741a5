// The smallest value of the world of this work-group, for its first work-item: item k takes every N_LANES-th of the
// world's values, then the first item takes theirs.
#ifndef PVG_SOLVE_WORLD_LEAST_CL
#define PVG_SOLVE_WORLD_LEAST_CL
#include "shared/real.h"
#include "shared/types.h"
#define N_LANES 64u

// first: [n_worlds + 1] runs of the worlds in values;  none: where there are no values;  of_lane: [N_LANES]
static inline real least_of_world(global const u32* restrict first, global const real* restrict values, const real none,
                                  local real* of_lane) {
  const uint world = get_group_id(0), item = get_local_id(0), end = first[world + 1];
  real own = none;
  for (uint k = first[world] + item; k < end; k += N_LANES) own = values[k] < own ? values[k] : own;
  of_lane[item] = own;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item > 0) return own;
  for (uint k = 1; k < N_LANES; ++k) own = fmin(own, of_lane[k]);
  return own;
}

#endif
