// The barrier as a function of the gap g = d - offset [m], and the edge-edge mollifier.
//   b(g) = -(g - d_hat)^2 ln(g / d_hat) / d_hat   [m]      for 0 < g < d_hat, 0 beyond, infinite at g <= 0
//   m(c) = (2 - c / eps) c / eps                  for c = |e0 x e1|^2 < eps, else 1
// Li et al. 2020, "Incremental Potential Contact", here in the distance itself and divided by d_hat, so that kappa b'
// is a pressure.
#ifndef PVG_ENERGIES_BARRIER_LAW_CL
#define PVG_ENERGIES_BARRIER_LAW_CL
#include "contact/distance.cl"
#include "energies/contact/barrier.h"

static inline real barrier_value(const real g, const real d_hat) {
  // written so that NaN counts as penetration
  if (!(g > 0)) return INFINITY;
  return g < d_hat ? -(g - d_hat) * (g - d_hat) * log(g / d_hat) / d_hat : 0;
}

// b' [-], <= 0
static inline real barrier_slope(const real g, const real d_hat) {
  if (!(g > 0)) return -INFINITY;
  return g < d_hat ? -(g - d_hat) * (2 * log(g / d_hat) + (g - d_hat) / g) / d_hat : 0;
}

// b'' [1/m], >= 0
static inline real barrier_curvature(const real g, const real d_hat) {
  if (!(g > 0)) return INFINITY;
  const real q = (g - d_hat) / g;
  return g < d_hat ? -(2 * log(g / d_hat) + 4 * q - q * q) / d_hat : 0;
}

// m and its derivatives [1/m^4, 1/m^8] at c [m^4]
typedef struct {
  real value, slope, curvature;
} Mollifier;

// where an edge pair is not mollified, and for a point and a triangle: {1, 0, 0}
static inline Mollifier mollifier_at(const real c, const real threshold) {
  const Mollifier one = {1, 0, 0};
  if (!(c < threshold)) return one;
  const real q = c / threshold;
  const Mollifier m = {(2 - q) * q, (2 - 2 * q) / threshold, -2 / (threshold * threshold)};
  return m;
}

// c = |e0 x e1|^2 of an edge pair
static inline real parallelism(const real3* x) {
  const real3 normal = cross(x[1] - x[0], x[3] - x[2]);
  return dot(normal, normal);
}

static inline Mollifier pair_mollifier(const Barrier* p, const real3* x) {
  return mollifier_at(p->kind == EDGE_EDGE ? parallelism(x) : INFINITY, p->mollifier_threshold);
}

#endif
