// out = H d of an element of four sites.
#ifndef PVG_SOLVE_PRODUCT_OF_FOUR_CL
#define PVG_SOLVE_PRODUCT_OF_FOUR_CL
#include "shared/real.h"

// H: [12 x 12, row-major];  d, out: [12]
static inline void product_of_four(global const real* H, const real* d, global real* out) {
  for (int i = 0; i < 12; ++i) {
    real sum = 0;
    for (int j = 0; j < 12; ++j) sum += H[i * 12 + j] * d[j];
    out[i] = sum;
  }
}

#endif
