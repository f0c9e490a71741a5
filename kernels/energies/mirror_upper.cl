// Symmetric matrices of which only the upper half was computed.
#ifndef PVG_ENERGIES_MIRROR_UPPER_CL
#define PVG_ENERGIES_MIRROR_UPPER_CL
#include "shared/real.h"

// Fills what lies below the diagonal from what lies above it. H: row-major [size x size]
static inline void mirror_upper(const int size, real* H) {
  for (int i = 1; i < size; ++i)
    for (int j = 0; j < i; ++j) H[i * size + j] = H[j * size + i];
}

#endif
