// The smallest value of the world of this work-group, for its first work-item: item k takes every ITEMS-th of the
// world's values, then the first item takes theirs.
#ifndef PVG_SOLVE_WORLD_LEAST_CL
#define PVG_SOLVE_WORLD_LEAST_CL
#include "shared/real.h"
#include "shared/types.h"
#define ITEMS 64u

// first: [n_worlds + 1] runs of the worlds in values;  none: where there are no values;  of_item: [ITEMS]
static inline real least_of_world(global const u32* restrict first, global const real* restrict values, const real none,
                                  local real* of_item) {
  const uint world = get_group_id(0), item = get_local_id(0), end = first[world + 1];
  real own = none;
  uint k = first[world] + item;
  for (; k + 7 * ITEMS < end; k += 8 * ITEMS) {  // fetched together
    real eight[8];
    for (uint j = 0; j < 8; ++j) eight[j] = values[k + j * ITEMS];
    for (uint j = 0; j < 8; ++j) own = eight[j] < own ? eight[j] : own;
  }
  for (; k < end; k += ITEMS) own = values[k] < own ? values[k] : own;
  of_item[item] = own;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item > 0) return own;
  for (uint k = 1; k < ITEMS; ++k) own = fmin(own, of_item[k]);
  return own;
}

// The smallest of values[begin] to values[end - 1], each in [0, 1], or 1, for the first work-item.
// of_64: the smallest of each 64 values
static inline real least_of_pairs(const uint begin, const uint end, global const real* restrict values,
                                  global const real* restrict of_64, local real* of_item) {
  const uint item = get_local_id(0), first_whole = (begin + ITEMS - 1) / ITEMS, last_whole = end / ITEMS;
  const bool has_whole = first_whole < last_whole;
  const uint head = has_whole ? first_whole * ITEMS : end, tail = has_whole ? last_whole * ITEMS : end;
  real own = 1;
  for (uint k = begin + item; k < head; k += ITEMS) own = fmin(own, values[k]);
  for (uint g = first_whole + item; g < last_whole; g += ITEMS) own = fmin(own, of_64[g]);
  for (uint k = tail + item; k < end; k += ITEMS) own = fmin(own, values[k]);
  of_item[item] = own;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint k = 0; k < (item == 0 ? ITEMS : 0); ++k) own = fmin(own, of_item[k]);
  return own;
}

#endif
