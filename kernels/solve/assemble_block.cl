#ifndef PVG_SOLVE_ASSEMBLE_BLOCK_CL
#define PVG_SOLVE_ASSEMBLE_BLOCK_CL
#include "shared/look_ahead.cl"
#include "shared/real.h"
#define NEW_TERM (1u << 31)
#define TRANSPOSED (1u << 30)
#define SOURCE (TRANSPOSED - 1u)
#define PARTS_AHEAD 16u

// Each block of the matrix is the sum of the parts of dense element blocks that fall on it: of each term by itself, in
// the order of its elements, then of the terms in their order. Of elements the blocks on and above the diagonal are kept
// (energies/upper_blocks.cl), of the matrix only the upper half is summed; both halves are written.
// i: of the blocks on and above the diagonal;  place: [n_blocks x 2] where each stands in the matrix, and
// its transpose
// part_first: [n_blocks + 1] into the parts;  source: the part's number among the element blocks, with NEW_TERM where it
// is the first one of a term, TRANSPOSED where it falls on the transposed block; PARTS_AHEAD more of any part at the end
static inline void assemble_block(const uint i, global const uint* restrict place,
                                  global const uint* restrict part_first, global const uint* restrict source,
                                  global const real* restrict weight,
                                  global const real* restrict element_blocks, global real* restrict blocks) {
  real3 sum0 = (real3)(0), sum1 = (real3)(0), sum2 = (real3)(0);
  real3 row0 = (real3)(0), row1 = (real3)(0), row2 = (real3)(0);
  for (uint k = part_first[i]; k < part_first[i + 1]; ++k) {
    if (source[k] & NEW_TERM) {
      sum0 += row0, sum1 += row1, sum2 += row2;
      row0 = row1 = row2 = (real3)(0);
    }
    global const real* ahead = element_blocks + 9 * (size_t)(source[k + PARTS_AHEAD] & SOURCE);
    look_ahead(ahead);
    look_ahead(ahead + 8);  // its end may stand in the next line of the cache
    global const real* part = element_blocks + 9 * (size_t)(source[k] & SOURCE);
    const real3 p0 = vload3(0, part), p1 = vload3(1, part), p2 = vload3(2, part);
    if (source[k] & TRANSPOSED) {
      row0 += weight[k] * (real3)(p0.x, p1.x, p2.x);
      row1 += weight[k] * (real3)(p0.y, p1.y, p2.y);
      row2 += weight[k] * (real3)(p0.z, p1.z, p2.z);
    } else {
      row0 += weight[k] * p0;
      row1 += weight[k] * p1;
      row2 += weight[k] * p2;
    }
  }
  sum0 += row0, sum1 += row1, sum2 += row2;
  global real* block = blocks + 9 * (size_t)place[2 * i];
  vstore3(sum0, 0, block);
  vstore3(sum1, 1, block);
  vstore3(sum2, 2, block);
  if (place[2 * i] == place[2 * i + 1]) return;
  block = blocks + 9 * (size_t)place[2 * i + 1];
  vstore3((real3)(sum0.x, sum1.x, sum2.x), 0, block);
  vstore3((real3)(sum0.y, sum1.y, sum2.y), 1, block);
  vstore3((real3)(sum0.z, sum1.z, sum2.z), 2, block);
}

#endif
