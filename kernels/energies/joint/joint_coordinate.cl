// The coordinate q of a joint and its derivatives, from the sites that its two bodies carry.
//   revolute:  q = atan2(s, c),  c = (n_i . n_j + b_i . b_j)/2,  s = (b_i . n_j - n_i . b_j)/2 [rad]
//     n, b: unit directions at right angles to the axis, b = axis x n, i on the parent and j on the child, equal at
//     q = 0; q > 0 turns the child about the axis by the right hand. Continued beyond half a turn from step to step.
//   prismatic: q = (c_j - c_i) . d_i,  points c_i on the parent and c_j on the child, unit direction d_i on the parent
//   [m]
#ifndef PVG_ENERGIES_JOINT_COORDINATE_CL
#define PVG_ENERGIES_JOINT_COORDINATE_CL
#include "shared/real.h"

// x: n_i, b_i, n_j, b_j
static inline real revolute_angle(const real3* x) {
  return atan2(dot(x[1], x[2]) - dot(x[0], x[3]), dot(x[0], x[2]) + dot(x[1], x[3]));
}

// The angle at x, given that it was angle0 at x0 and has changed by less than half a turn since.
static inline real revolute_coordinate(const real3* x, const real3* x0, const real angle0) {
  const real change = revolute_angle(x) - revolute_angle(x0);
  return angle0 + change - 2 * M_PI * rint(change / (2 * M_PI));
}

static inline void revolute_derivatives(const real3* x, real3 dq[4]) {
  const real c = 0.5 * (dot(x[0], x[2]) + dot(x[1], x[3]));
  const real s = 0.5 * (dot(x[1], x[2]) - dot(x[0], x[3]));
  // 1 for rigid bodies; 0 only where the axes of the bodies are opposed, and no angle is defined
  const real square = fmax(c * c + s * s, (real)1e-12);
  const real dc = -0.5 * s / square, ds = 0.5 * c / square;
  dq[0] = dc * x[2] - ds * x[3];
  dq[1] = dc * x[3] + ds * x[2];
  dq[2] = dc * x[0] + ds * x[1];
  dq[3] = dc * x[1] - ds * x[0];
}

// x: c_i, c_j, d_i
static inline real prismatic_coordinate(const real3* x) { return dot(x[1] - x[0], x[2]); }

static inline void prismatic_derivatives(const real3* x, real3 dq[3]) {
  dq[0] = -x[2];
  dq[1] = x[2];
  dq[2] = x[1] - x[0];
}

// H = k dq dq^T: Gauss-Newton, positive semi-definite. dq: [n];  H: row-major [3 n x 3 n]
static inline void joint_hessian(const real k, const int n, const real3* dq, real* H) {
  for (int a = 0; a < n; ++a)
    for (int i = 0; i < 3; ++i) {
      const real left = k * (i == 0 ? dq[a].x : i == 1 ? dq[a].y : dq[a].z);
      for (int b = 0; b < n; ++b) vstore3(left * dq[b], 0, H + (3 * a + i) * 3 * n + 3 * b);
    }
}

#endif
