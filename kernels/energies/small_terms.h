// What the kernels of several energy terms in one launch know of each of them (host/physics/energies/small_terms.cpp).
#ifndef PVG_ENERGIES_SMALL_TERMS_H
#define PVG_ENERGIES_SMALL_TERMS_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 first_item, n;  // work-items: a term begins with a work-group of its own
  u32 first_byte;     // of its elements in the buffer of all terms
  u32 first_energy, first_row, first_block;
  u32 unused[2];
} SmallTerm;
SHARED_SIZE(SmallTerm, 32);
SHARED_END
#endif
