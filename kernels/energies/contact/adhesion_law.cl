// Attraction of two surfaces, beside the barrier: gamma a(g) per area, g the gap, within the activation distance d:
//   a(g) = -(1 - s)^2 (1 + 2 s),  s = g / d       so that parting them costs gamma, at most at 1.5 gamma / d per area
// That pull is at s = 1/2. The barrier of surfaces that attract acts within d / 2 only: being much stiffer, it would
// hide the attraction further out.
#ifndef PVG_ENERGIES_ADHESION_LAW_CL
#define PVG_ENERGIES_ADHESION_LAW_CL
#include "shared/real.h"

// where the barrier acts [m]
static inline real barrier_range(const real adhesion, const real d) { return adhesion > 0 ? 0.5 * d : d; }

static inline real adhesion_value(const real g, const real d) {
  const real s = g / d;
  return s < 1 ? -(1 - s) * (1 - s) * (1 + 2 * s) : 0;
}

// a' [1/m], >= 0
static inline real adhesion_slope(const real g, const real d) {
  const real s = g / d;
  return s < 1 ? 6 * s * (1 - s) / d : 0;
}

// a'' [1/m^2], negative in the outer half
static inline real adhesion_curvature(const real g, const real d) {
  const real s = g / d;
  return s < 1 ? 6 * (1 - 2 * s) / (d * d) : 0;
}

#endif
