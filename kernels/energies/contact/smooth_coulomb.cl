// The distance y that something has slid, smoothed where it sticks, so that a force times it is a friction potential:
//   f0(y) = -y^3 / (3 eps^2) + y^2 / eps + eps / 3    for y < eps, else y          [m or rad]
// Li et al. 2020, "Incremental Potential Contact"; eps: sliding within the step at which friction is fully developed.
#ifndef PVG_ENERGIES_SMOOTH_COULOMB_CL
#define PVG_ENERGIES_SMOOTH_COULOMB_CL
#include "shared/real.h"

static inline real smooth_coulomb(const real y, const real eps) {
  return y < eps ? y * y * (1 - y / (3 * eps)) / eps + eps / 3 : y;
}

// f0'(y) / y [1/m], finite at y = 0
static inline real smooth_coulomb_slope_over(const real y, const real eps) {
  return y < eps ? (2 - y / eps) / eps : 1 / y;
}

// (f0'/y - f0'') / y^2 [1/m^3]: what the second derivative of f0(|u|) lacks along u, times u u^T; 0 at y = 0, where
// there is no direction
static inline real smooth_coulomb_less_along(const real y, const real eps) {
  return y > 0 ? (y < eps ? 1 / (eps * eps * y) : 1 / (y * y * y)) : 0;
}

// d/dy (y / f0'): 1 where friction is fully developed
static inline real smooth_coulomb_ratio_slope(const real y, const real eps) {
  return y < eps ? 1 / ((2 - y / eps) * (2 - y / eps)) : 1;
}

#endif
