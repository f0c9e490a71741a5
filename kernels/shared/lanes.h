// A number of each of N_LANES elements side by side, where a kernel does the same arithmetic for every element: the vectors
// of a CPU, whose compiler finds them by itself only in loops without decisions. A device whose work-items are its lanes
// has one in each. Comparisons make a lane_mask; `mask ? a : b` chooses lane by lane. Device only.
#ifndef PVG_SHARED_LANES_H
#define PVG_SHARED_LANES_H
#include "shared/real.h"

#if defined(__AVX512F__)
#define N_LANES 8
typedef double8 lanes;
typedef long8 lane_mask;
#elif defined(__AVX__)
#define N_LANES 4
typedef double4 lanes;
typedef long4 lane_mask;
#else
#define N_LANES 1
typedef real lanes;
typedef int lane_mask;
#endif

#if N_LANES > 1
#define ANY_LANE(mask) any(mask)
#else
#define ANY_LANE(mask) (mask)
#endif
#define LANE(v, lane) (((real*)&(v))[lane])

// Lane by lane, `value` of the element `e`, which counts from the first one; where there are fewer than N_LANES, of the
// last one again.
#define SET_LANES(v, n_elements, value)                \
  for (uint lane = 0; lane < N_LANES; ++lane) {          \
    const uint e = min(lane, (uint)(n_elements) - 1u); \
    LANE(v, lane) = (value);                           \
  }

static inline lanes lanes_dot(const lanes* a, const lanes* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void lanes_cross(const lanes* a, const lanes* b, lanes* c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
