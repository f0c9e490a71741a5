// What conjugate gradients keep of one world on the device (solve/conjugate_gradients.cl).
#ifndef PVG_SOLVE_CG_WORLD_H
#define PVG_SOLVE_CG_WORLD_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  f64 rz, rz_old, first_rz, pad_;  // r . z now, one iteration before and at first
  u32 is_active, iterations, has_converged;
  u32 residual_tells;  // that it is done, as cg_test_residual would find
} CgWorld;
SHARED_SIZE(CgWorld, 48);
SHARED_END
#endif
