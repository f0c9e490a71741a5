// What one work-group finds of a world, in a fixed order: each work-item takes chunks of consecutive elements, then the
// first one adds up what they found. Chunks begin at each world's first element, so a world's bits do not depend on its
// companions. Of a large world the chunks are taken by many work-groups before, in a launch of their own: same bits.
#ifndef PVG_SOLVE_WORLD_SUM_CL
#define PVG_SOLVE_WORLD_SUM_CL
#include "shared/real.h"
#include "solve/site.h"
#define ITEMS 64u

static inline real sum_of(const uint begin, const uint end, global const real* a) {
  real sum = 0;
  for (uint i = begin; i < end; ++i) sum += a[i];
  return sum;
}

#endif
