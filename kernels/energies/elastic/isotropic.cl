// Second derivatives of an isotropic energy Psi(F), projected to positive semi-definite in closed form.
// With F = U diag(sigma) V^T, the quadratic form of d2Psi/dF2 on dF splits, in the entries d = U^T dF V, into
//   sum_ij A_ij d_ii d_jj                               stretch: A = d2Psi / dsigma_i dsigma_j
//   + sum_k twist_k (d_ij - d_ji)^2 / 2                 (i, j, k all different)
//   + sum_k flip_k  (d_ij + d_ji)^2 / 2
// with twist_k = (Psi_i + Psi_j) / (sigma_i + sigma_j) and flip_k = (Psi_i - Psi_j) / (sigma_i - sigma_j).
// Smith, De Goes, Kim 2019, "Analytic Eigensystems for Isotropic Distortion Energies".
#ifndef PVG_ENERGIES_ISOTROPIC_CL
#define PVG_ENERGIES_ISOTROPIC_CL
#include "energies/mirror_upper.cl"
#include "shared/svd.cl"

typedef struct {
  Mat3 u, v;
  Mat3 stretch;       // [Pa]
  real3 twist, flip;  // entry k belongs to the two other indices [Pa]
} IsotropicHessian;

// Clamps every eigenvalue at zero.
static inline void isotropic_project(IsotropicHessian* e) {
  e->stretch = mat3_nearest_positive(e->stretch);
  e->twist = fmax(e->twist, (real3)(0, 0, 0));
  e->flip = fmax(e->flip, (real3)(0, 0, 0));
}

// c[k][l]: the 3 x 3 block that couples the vectors dF v_k and dF v_l; c[l][k] is its transpose.
static inline void isotropic_column_blocks(const IsotropicHessian e, Mat3 c[3][3]) {
  // factors of d_ij^2 and of 2 d_ij d_ji
  const real3 same = 0.5 * (e.twist + e.flip), cross_term = 0.5 * (e.flip - e.twist);
  const real3 u0 = e.u.column[0], u1 = e.u.column[1], u2 = e.u.column[2];
  const Mat3 u00 = mat3_outer(u0, u0), u11 = mat3_outer(u1, u1), u22 = mat3_outer(u2, u2);
  const Mat3 u01 = mat3_outer(u0, u1), u02 = mat3_outer(u0, u2), u12 = mat3_outer(u1, u2);
  const Mat3 u10 = mat3_transposed(u01), u20 = mat3_transposed(u02), u21 = mat3_transposed(u12);
  const Mat3 a = e.stretch;
#define SUM3(m0, s0, m1, s1, m2, s2) mat3_plus(mat3_plus(mat3_scaled(m0, s0), mat3_scaled(m1, s1)), mat3_scaled(m2, s2))
#define SUM2(m0, s0, m1, s1) mat3_plus(mat3_scaled(m0, s0), mat3_scaled(m1, s1))
  c[0][0] = SUM3(u00, a.column[0].x, u11, same.z, u22, same.y);
  c[1][1] = SUM3(u00, same.z, u11, a.column[1].y, u22, same.x);
  c[2][2] = SUM3(u00, same.y, u11, same.x, u22, a.column[2].z);
  c[0][1] = SUM2(u01, a.column[1].x, u10, cross_term.z);
  c[0][2] = SUM2(u02, a.column[2].x, u20, cross_term.y);
  c[1][2] = SUM2(u12, a.column[2].y, u21, cross_term.x);
  c[1][0] = SUM2(u10, a.column[1].x, u01, cross_term.z);
  c[2][0] = SUM2(u20, a.column[2].x, u02, cross_term.y);
  c[2][1] = SUM2(u21, a.column[2].y, u12, cross_term.x);
#undef SUM2
#undef SUM3
}

// H += weight d2Psi(F) / dx_a dx_b for F = sum_a x_a b_a^T, blocks a <= b only.
// b: [n, 1/m or 1];  weight [m^3];  H: row-major [3 n x 3 n]
static inline void isotropic_add_hessian(const IsotropicHessian e, const real weight, const int n, const real3* b,
                                         global real* H) {
  Mat3 c[3][3];
  isotropic_column_blocks(e, c);
  for (int i = 0; i < n; ++i) {
    const real3 bi = weight * mat3_transposed_times(e.v, b[i]);
    // m[l]: transposed, so that its columns are the rows of the block that is written
    Mat3 m[3];
    for (int l = 0; l < 3; ++l)
      m[l] = mat3_plus(mat3_plus(mat3_scaled(c[l][0], bi.x), mat3_scaled(c[l][1], bi.y)), mat3_scaled(c[l][2], bi.z));
    for (int j = i; j < n; ++j) {
      const real3 bj = mat3_transposed_times(e.v, b[j]);
      for (int row = 0; row < 3; ++row) {
        global real* h = H + (3 * i + row) * 3 * n + 3 * j;
        const real3 sum = m[0].column[row] * bj.x + m[1].column[row] * bj.y + m[2].column[row] * bj.z;
        h[0] += sum.x;
        h[1] += sum.y;
        h[2] += sum.z;
      }
    }
  }
}

#endif
