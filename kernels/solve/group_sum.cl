// The sum of one number of each of a work-group's 64 work-items, in a fixed order: eights, then the sum of the eights.
#ifndef PVG_SOLVE_GROUP_SUM_CL
#define PVG_SOLVE_GROUP_SUM_CL
#include "shared/real.h"
#define ITEMS 64u
#define EIGHTS 8u

// Returns it to the first work-item, 0 to the others.  of_item: [ITEMS + EIGHTS], which no work-item reads any more
static inline real sum_of_group(const real own, local real* of_item) {
  const uint item = get_local_id(0);
  of_item[item] = own;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item < EIGHTS) {
    real sum = 0;
    for (uint k = 0; k < ITEMS / EIGHTS; ++k) sum += of_item[item * (ITEMS / EIGHTS) + k];
    of_item[ITEMS + item] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  real sum = 0;
  for (uint k = item == 0 ? 0 : EIGHTS; k < EIGHTS; ++k) sum += of_item[ITEMS + k];
  return sum;
}

#endif
