// Inertia: one row per node of a soft body (point mass) or per affine body (4 x 4 mass matrix).
#ifndef PVG_INERTIA_H
#define PVG_INERTIA_H
#include "shared/types.h"

SHARED_BEGIN
typedef struct {
  u32 site[1];
  u32 pad_;
  f64 mass;  // m [kg]
} PointInertia;
SHARED_SIZE(PointInertia, 16);
ENERGY_TERM(1, point_inertia, PointInertia, 1);

typedef struct {
  u32 site[4];   // p, a1, a2, a3
  f64 mass[10];  // integral of rho [1, X] [1, X]^T, upper triangle by rows  [kg, kg m, kg m^2]
} AffineInertia;
SHARED_SIZE(AffineInertia, 96);
ENERGY_TERM(2, affine_inertia, AffineInertia, 4);
SHARED_END
#endif
