// Draws two sites together.
#ifndef PVG_ENERGIES_ZERO_LENGTH_SPRING_H
#define PVG_ENERGIES_ZERO_LENGTH_SPRING_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[2];    // two points, or two directions (the stiffness is then in J)
  f64 stiffness;  // k [N/m], >= 0
} ZeroLengthSpring;
SHARED_SIZE(ZeroLengthSpring, 16);
ENERGY_TERM(6, zero_length_spring, ZeroLengthSpring, 2);
SHARED_END
#endif
