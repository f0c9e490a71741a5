// Holds the axes of an affine body to a rotation.
#ifndef PVG_ENERGIES_AFFINE_ORTHOGONALITY_H
#define PVG_ENERGIES_AFFINE_ORTHOGONALITY_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[3];  // the body's axes a1, a2, a3: directions, the columns of A in x(X) = p + A X
  u32 unused;
  f64 stiffness;  // k = kappa V, modulus times volume [J]
  f64 unused_too;
} AffineOrthogonality;
SHARED_SIZE(AffineOrthogonality, 32);
ENERGY_TERM(5, affine_orthogonality, AffineOrthogonality, 3);
SHARED_END
#endif
