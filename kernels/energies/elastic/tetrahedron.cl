// Shape functions of tetrahedra and what they make of the positions of their nodes.
//   4 nodes:   N_a = L_a, the barycentric coordinates: F is constant in the element
//   10 nodes:  N_a = L_a (2 L_a - 1) of a corner, 4 L_a L_b of the midpoint of edge ab (01 12 02 03 13 23); four
//              quadrature points of equal weight, exact to second degree. Straight sides at rest make grad L_a
//              constant.
// rest_inverse: [9, 1/m] row-major inverse of [X1-X0, X2-X0, X3-X0]: its rows are grad L_1, grad L_2, grad L_3.
#ifndef PVG_ENERGIES_TETRAHEDRON_CL
#define PVG_ENERGIES_TETRAHEDRON_CL
#include "shared/lanes.h"
#include "shared/mat3.cl"

// barycentric coordinates of the quadrature points: (5 + 3 sqrt 5) / 20 toward one corner, (5 - sqrt 5) / 20 else
#define TETRAHEDRON_NEAR 0.58541019662496845446
#define TETRAHEDRON_FAR 0.13819660112501051518

// b: gradients of the 4 shape functions [1/m]
static inline void tetrahedron_4_gradients(const real* rest_inverse, real3 b[4]) {
  for (int a = 0; a < 3; ++a) b[a + 1] = vload3(a, rest_inverse);
  b[0] = -(b[1] + b[2] + b[3]);
}

// b: gradients of the 10 shape functions at quadrature point q [1/m]
static inline void tetrahedron_10_gradients(const real* rest_inverse, const int q, real3 b[10]) {
  real3 l[4];
  tetrahedron_4_gradients(rest_inverse, l);
  real at[4];
  for (int a = 0; a < 4; ++a) at[a] = a == q ? TETRAHEDRON_NEAR : TETRAHEDRON_FAR;
  for (int a = 0; a < 4; ++a) b[a] = (4 * at[a] - 1) * l[a];
  b[4] = 4 * (at[0] * l[1] + at[1] * l[0]);
  b[5] = 4 * (at[1] * l[2] + at[2] * l[1]);
  b[6] = 4 * (at[0] * l[2] + at[2] * l[0]);
  b[7] = 4 * (at[0] * l[3] + at[3] * l[0]);
  b[8] = 4 * (at[1] * l[3] + at[3] * l[1]);
  b[9] = 4 * (at[2] * l[3] + at[3] * l[2]);
}

// F = sum_a x_a b_a^T
static inline Mat3 tetrahedron_deformation(const int n, const real3* x, const real3* b) {
  Mat3 f = mat3_outer(x[0], b[0]);
  for (int a = 1; a < n; ++a) f = mat3_plus(f, mat3_outer(x[a], b[a]));
  return f;
}

// ---- the same for N_LANES elements

// rest_inverse: [9, 1/m];  b: [4][3, 1/m]
static inline void lanes_tetrahedron_4_gradients(const lanes* rest_inverse, lanes (*b)[3]) {
  for (int k = 0; k < 3; ++k) {
    for (int a = 0; a < 3; ++a) b[a + 1][k] = rest_inverse[3 * a + k];
    b[0][k] = -(b[1][k] + b[2][k] + b[3][k]);
  }
}

// l: gradients of the barycentric coordinates [4][3, 1/m];  b: [10][3, 1/m]
static inline void lanes_tetrahedron_10_gradients(const lanes (*l)[3], const int q, lanes (*b)[3]) {
  real at[4];
  for (int a = 0; a < 4; ++a) at[a] = a == q ? TETRAHEDRON_NEAR : TETRAHEDRON_FAR;
  for (int k = 0; k < 3; ++k) {
    for (int a = 0; a < 4; ++a) b[a][k] = (4 * at[a] - 1) * l[a][k];
    b[4][k] = 4 * (at[0] * l[1][k] + at[1] * l[0][k]);
    b[5][k] = 4 * (at[1] * l[2][k] + at[2] * l[1][k]);
    b[6][k] = 4 * (at[0] * l[2][k] + at[2] * l[0][k]);
    b[7][k] = 4 * (at[0] * l[3][k] + at[3] * l[0][k]);
    b[8][k] = 4 * (at[1] * l[3][k] + at[3] * l[1][k]);
    b[9][k] = 4 * (at[2] * l[3][k] + at[3] * l[2][k]);
  }
}

// x: [n][3, m];  f: [column][row]
static inline void lanes_tetrahedron_deformation(const int n, const lanes (*x)[3], const lanes (*b)[3],
                                                 lanes f[3][3]) {
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      lanes sum = x[0][row] * b[0][column];
      for (int a = 1; a < n; ++a) sum += x[a][row] * b[a][column];
      f[column][row] = sum;
    }
}

#endif
