// Largest lengths at sites; the largest of numbers is the same in any order.
#ifndef PVG_SOLVE_WORLD_LARGEST_CL
#define PVG_SOLVE_WORLD_LARGEST_CL
#include "solve/value_at_site.cl"

// the larger of two lengths; a length that is not a number is infinite
static inline real larger(const real largest, const real length) {
  return length <= largest ? largest : (isnan(length) ? INFINITY : length);
}

// largest |a| over the chunk's sites from its first one on, each `stride`-th;  a: [n_nodes x 3]
static inline real largest_of_chunk(const Chunk chunk, const uint first, const uint stride,
                                    global const Site* restrict sites, global const real* restrict a) {
  real largest = 0;
  for (uint i = chunk.begin + first; i < chunk.end; i += stride)
    largest = larger(largest, length(value_at_site(sites + i, a)));
  return largest;
}

#endif
