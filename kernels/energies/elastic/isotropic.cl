// Second derivatives of an isotropic energy Psi(F), projected to positive semi-definite in closed form.
// With F = U diag(sigma) V^T, the quadratic form of d2Psi/dF2 on dF splits, in the entries d = U^T dF V, into
//   sum_ij A_ij d_ii d_jj                               stretch: A = d2Psi / dsigma_i dsigma_j
//   + sum_k twist_k (d_ij - d_ji)^2 / 2                 (i, j, k all different)
//   + sum_k flip_k  (d_ij + d_ji)^2 / 2
// with twist_k = (Psi_i + Psi_j) / (sigma_i + sigma_j) and flip_k = (Psi_i - Psi_j) / (sigma_i - sigma_j).
// Smith, De Goes, Kim 2019, "Analytic Eigensystems for Isotropic Distortion Energies".
// All for N_LANES elements.
#ifndef PVG_ENERGIES_ISOTROPIC_CL
#define PVG_ENERGIES_ISOTROPIC_CL
#include "energies/upper_blocks.cl"
#include "shared/svd.cl"

typedef struct {
  LanesSvd3 svd;
  lanes stretch[3][3];       // [Pa]
  lanes twist[3], flip[3];   // entry k belongs to the two other indices [Pa]
} IsotropicHessian;

// Clamps every eigenvalue at zero.
static inline void isotropic_project(IsotropicHessian* e) {
  lanes_set_nearest_positive(e->stretch);
  for (int k = 0; k < 3; ++k) {
    e->twist[k] = fmax(e->twist[k], (lanes)(0));
    e->flip[k] = fmax(e->flip[k], (lanes)(0));
  }
}

// c[k][l]: weight times the 3 x 3 block [row][column] that couples the vectors dF v_k and dF v_l; c[l][k] is its
// transpose, and only l >= k is set.
static inline void isotropic_column_blocks(const IsotropicHessian* e, const lanes weight, lanes c[3][3][3][3]) {
#pragma unroll
  for (int k = 0; k < 3; ++k)
#pragma unroll
    for (int l = k; l < 3; ++l) {
      // what multiplies u_k u_l^T and u_l u_k^T; d_ij^2 and 2 d_ij d_ji of the planes (i, j)
      const lanes *uk = e->svd.u[k], *ul = e->svd.u[l];
      if (k == l) {
        const int m = (k + 1) % 3, n = (k + 2) % 3;
        const lanes along = weight * e->stretch[k][k];
        const lanes same_n = 0.5 * weight * (e->twist[n] + e->flip[n]), same_m = 0.5 * weight * (e->twist[m] + e->flip[m]);
        const lanes *um = e->svd.u[m], *un = e->svd.u[n];
#pragma unroll
        for (int i = 0; i < 3; ++i)
#pragma unroll
          for (int j = 0; j < 3; ++j)
            c[k][k][i][j] = along * uk[i] * uk[j] + same_n * um[i] * um[j] + same_m * un[i] * un[j];
      } else {
        const int n = 3 - k - l;
        const lanes along = weight * e->stretch[k][l], across = 0.5 * weight * (e->flip[n] - e->twist[n]);
#pragma unroll
        for (int i = 0; i < 3; ++i)
#pragma unroll
          for (int j = 0; j < 3; ++j) c[k][l][i][j] = along * uk[i] * ul[j] + across * ul[i] * uk[j];
      }
    }
}

// Where the upper half of an element's matrix is summed (upper_blocks.cl). With several lanes it is a private array of its
// own, stored at the end; with one it is where the numbers belong, since such an array would take up to 4 KB of memory
// for each work-item.
#if N_LANES > 1
#define UPPER_SUM(sum, n, H) lanes sum[9 * (n) * ((n) + 1) / 2]
typedef lanes* UpperSum;
#else
#define UPPER_SUM(sum, n, H) global real* sum = H
typedef global real* UpperSum;
#endif

static inline void clear_upper(const int n, UpperSum sum) {
  for (int k = 0; k < n_upper_numbers(n); ++k) sum[k] = (lanes)(0);
}

// sum += weight d2Psi(F) / dx_a dx_b for F = sum_a x_a b_a^T, blocks a <= b.
// b: [n <= 10, 1/m or 1];  weight [m^3]
static inline void isotropic_add_hessian(const IsotropicHessian* e, const lanes weight, const int n,
                                         const lanes (*b)[3], UpperSum sum) {
  lanes c[3][3][3][3], r[10][3];  // r: V^T b
  isotropic_column_blocks(e, weight, c);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) r[i][k] = lanes_dot(e->svd.v[k], b[i]);
#if N_LANES == 1  // arrays that are indexed at run time lie in memory
#pragma unroll
#endif
  for (int i = 0; i < n; ++i) {
    lanes m[3][3][3];  // [l]: sum_k r_k c[k][l]
#pragma unroll
    for (int row = 0; row < 3; ++row)
#pragma unroll
      for (int column = 0; column < 3; ++column) {
        m[0][row][column] =
            r[i][0] * c[0][0][row][column] + r[i][1] * c[0][1][column][row] + r[i][2] * c[0][2][column][row];
        m[1][row][column] =
            r[i][0] * c[0][1][row][column] + r[i][1] * c[1][1][row][column] + r[i][2] * c[1][2][column][row];
        m[2][row][column] =
            r[i][0] * c[0][2][row][column] + r[i][1] * c[1][2][row][column] + r[i][2] * c[2][2][row][column];
      }
#if N_LANES == 1
#pragma unroll
#endif
    for (int j = i; j < n; ++j) {
      UpperSum block = sum + upper_block(n, i, j);
#pragma unroll
      for (int row = 0; row < 3; ++row)
#pragma unroll
        for (int column = 0; column < 3; ++column)
          block[3 * row + column] +=
              m[0][row][column] * r[j][0] + m[1][row][column] * r[j][1] + m[2][row][column] * r[j][2];
    }
  }
}

// The sums of the first n_elements lanes, the upper blocks of one element after those of the other.
static inline void store_upper(const int n, const uint n_elements, UpperSum sum, global real* H) {
#if N_LANES > 1
  const int n_numbers = n_upper_numbers(n);
  for (int first = 0; first < n_numbers; first += 9) {
    const real* number = (const real*)(sum + first);
    global real* block = H + first;
    for (uint lane = 0; lane < n_elements; ++lane, ++number, block += n_numbers) {
      vstore8((double8)(number[0], number[N_LANES], number[2 * N_LANES], number[3 * N_LANES], number[4 * N_LANES],
                      number[5 * N_LANES], number[6 * N_LANES], number[7 * N_LANES]),
              0, block);
      block[8] = number[8 * N_LANES];
    }
  }
#endif
}

#endif
