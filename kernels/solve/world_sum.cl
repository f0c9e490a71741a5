// What one work-group finds of a world, in a fixed order: each work-item takes chunks of consecutive elements, then the
// first one adds up what they found. Chunks begin at each world's first element, so a world's bits do not depend on its
// companions. Of a large world the chunks are taken by many work-groups before, in a launch of their own: same bits.
#ifndef PVG_SOLVE_WORLD_SUM_CL
#define PVG_SOLVE_WORLD_SUM_CL
#include "shared/real.h"
#include "solve/site.h"
#define ITEMS 64u

// sum + a_begin + a_begin+1 ..., one after the other, of which a GPU fetches eight at a time
static inline real add_up(real sum, const uint begin, const uint end, global const real* a) {
  uint i = begin;
  for (; i + 8 <= end; i += 8) {
    const double8 eight = vload8(0, a + i);
    sum += eight.s0;
    sum += eight.s1;
    sum += eight.s2;
    sum += eight.s3;
    sum += eight.s4;
    sum += eight.s5;
    sum += eight.s6;
    sum += eight.s7;
  }
  for (; i < end; ++i) sum += a[i];
  return sum;
}

static inline real sum_of(const uint begin, const uint end, global const real* a) { return add_up(0, begin, end, a); }

#endif
