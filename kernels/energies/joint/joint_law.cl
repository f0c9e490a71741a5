// What a law f(q, v) of a joint does along its coordinate q, v = (q - q0) / h its rate, q0 and h those of its row: an
// effort of f at the end of the step, the derivative of
//   V(q) = - integral from q0 to q of f(s, (s - q0) / h) ds                                                         [J]
// by Gauss and Legendre's rule of 5 points on panels that halve toward q0, where laws of friction are steep in v. The
// curvature is the central difference of -f along q, or zero where that is negative.
//   JOINT_LAWS: `case NUMBER: return EXPRESSION;` of each law, made by the host (host/physics/energies/laws.cpp)
#ifndef PVG_ENERGIES_JOINT_LAW_CL
#define PVG_ENERGIES_JOINT_LAW_CL
#include "shared/real.h"

#ifndef JOINT_LAWS
#define JOINT_LAWS
#endif

#define JOINT_LAW_PANELS 10

constant real JOINT_LAW_NODE[5] = {-0.906179845938663992797626878299393, -0.538469310105683091036314420700209, 0,
                                   0.538469310105683091036314420700209, 0.906179845938663992797626878299393};
constant real JOINT_LAW_WEIGHT[5] = {0.236926885056189087514264040719917, 0.478628670499366468041291514835638,
                                     0.568888888888888888888888888888889, 0.478628670499366468041291514835638,
                                     0.236926885056189087514264040719917};

// c: coefficients;  effort [N m or N]
static inline real joint_law_effort(const uint law, const real q, const real v, const real* c) {
  switch (law) { JOINT_LAWS }
  return 0;
}

static inline real joint_law_energy(const uint law, const real q, const real q0, const real h, const real* c) {
  real sum = 0, far = q - q0;
  for (int panel = 1; panel <= JOINT_LAW_PANELS; ++panel) {
    const real near = panel < JOINT_LAW_PANELS ? 0.5 * far : 0;
    const real middle = 0.5 * (near + far), half_length = 0.5 * (far - near);
    for (int k = 0; k < 5; ++k) {
      const real moved = middle + half_length * JOINT_LAW_NODE[k];
      sum += half_length * JOINT_LAW_WEIGHT[k] * joint_law_effort(law, q0 + moved, moved / h, c);
    }
    far = near;
  }
  return -sum;
}

static inline real joint_law_slope(const uint law, const real q, const real q0, const real h, const real* c) {
  return -joint_law_effort(law, q, (q - q0) / h, c);
}

static inline real joint_law_curvature(const uint law, const real q, const real q0, const real h, const real* c) {
  const real step = 1e-4 * h;  // v differs by 2e-4 rad/s or m/s
  const real change = joint_law_slope(law, q + step, q0, h, c) - joint_law_slope(law, q - step, q0, h, c);
  return fmax((real)0, change / (2 * step));
}

#endif
