// What one work-group finds of a world, in a fixed order: each work-item takes chunks of consecutive elements, then the
// first one adds up what they found. Chunks begin at each world's first element, so a world's bits do not depend on its
// companions. Of a large world the chunks are taken by many work-groups before, in a launch of their own: same bits.
#ifndef PVG_SOLVE_WORLD_SUM_CL
#define PVG_SOLVE_WORLD_SUM_CL
#include "shared/real.h"
#include "solve/site.h"
#define ITEMS 64u

static inline real dot_of_chunk(const Chunk chunk, global const real* restrict a, global const real* restrict b) {
  real sum = 0;
  for (uint i = chunk.begin; i < chunk.end; ++i) sum += dot(vload3(i, a), vload3(i, b));
  return sum;
}

static inline real sum_of(const uint begin, const uint end, global const real* a) {
  real sum = 0;
  for (uint i = begin; i < end; ++i) sum += a[i];
  return sum;
}

// The sum of a . b over the world of this work-group, for its first work-item.
// first: [n_worlds + 1] chunks of each world;  a, b: [n_elements x 3];  partial: [n_chunks], given if has_partial
static inline real dot_of_world(const uint has_partial, global const uint* restrict first,
                                global const Chunk* restrict chunks, global const real* restrict a,
                                global const real* restrict b, global real* partial) {
  const uint w = get_group_id(0), begin = first[w], end = first[w + 1];
  for (uint c = has_partial ? end : begin + get_local_id(0); c < end; c += ITEMS)
    partial[c] = dot_of_chunk(chunks[c], a, b);
  barrier(CLK_GLOBAL_MEM_FENCE);
  return get_local_id(0) == 0 ? sum_of(begin, end, partial) : 0;
}

#endif
