// Stitch spring of no rest length:  E = k/2 |x_a - x_b|^2                                                           [J]
// Stitches of a soft body to its mount, and the anchors of fixed, revolute and spherical joints.
#include "energies/joint/zero_length_spring.h"
#include "shared/real.h"

static inline real zero_length_spring_energy(const ZeroLengthSpring p, const real3* x, const real3* x0, const real h) {
  const real3 gap = x[0] - x[1];
  return 0.5 * p.stiffness * dot(gap, gap);
}

static inline void zero_length_spring_gradient(const ZeroLengthSpring p, const real3* x, const real3* x0, const real h,
                                          real3* g) {
  g[0] = p.stiffness * (x[0] - x[1]);
  g[1] = -g[0];
}

static inline void zero_length_spring_hessian(const ZeroLengthSpring p, const real3* x, const real3* x0, const real h, real* H) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) H[6 * i + j] = i % 3 != j % 3 ? 0 : i == j ? p.stiffness : -p.stiffness;
}

#define TERM zero_length_spring
#define PARAMS ZeroLengthSpring
#define STENCIL 2
#include "energies/assemble.cl"
