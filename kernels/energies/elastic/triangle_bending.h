// Bending of a thin sheet: one triangle with its neighbours. The formulas stand in triangle_bending.cl.
#ifndef PVG_ENERGIES_TRIANGLE_BENDING_H
#define PVG_ENERGIES_TRIANGLE_BENDING_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[6];        // corners, then the apex of the neighbour across from each corner; a corner where there is none
  f64 rest_angle[3];  // across from each corner [rad]
  f64 stiffness[6];   // K, upper triangle 00 01 02 11 12 22 [J]; rows of missing neighbours are 0
} TriangleBending;
SHARED_SIZE(TriangleBending, 96);
ENERGY_TERM(18, triangle_bending, TriangleBending, 6);
SHARED_END
#endif
