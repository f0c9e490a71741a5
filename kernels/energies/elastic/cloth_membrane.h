// Woven membrane: one triangle with its two fibre directions. The formulas stand in cloth_membrane.cl.
#ifndef PVG_ENERGIES_CLOTH_MEMBRANE_H
#define PVG_ENERGIES_CLOTH_MEMBRANE_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[3];  // corners
  u32 unused;
  f64 rest_inverse[4];             // Dm^-1, row-major, Dm = [X1-X0, X2-X0] in (warp, weft) coordinates at rest [1/m]
  f64 area;                        // at rest [m^2]
  f64 stretch_warp, stretch_weft;  // k_u, k_v: along each fibre direction where the other keeps its length [N/m]
  f64 coupling;                    // k_p: of both directions, k_p^2 < k_u k_v [N/m]
  f64 shear;                       // shear modulus x thickness [N/m]
  f64 limit_strain;                // beyond it fibres stiffen, >= 0
  f64 stiffening;                  // of the cubic term, >= 0
  f64 padding;
} ClothMembrane;
SHARED_SIZE(ClothMembrane, 112);
ENERGY_TERM(17, cloth_membrane, ClothMembrane, 3);
SHARED_END
#endif
