// Eigenvalues of a small symmetric matrix by cyclic Jacobi rotations (Golub, Van Loan, "Matrix Computations", 8.5), and
// its nearest positive semi-definite matrix. Include once per size:
//   #define EIGEN_N 3
//   #include "shared/symmetric_eigen.cl"
// makes symmetric_eigen_3(A, V) and project_to_psd_3(A). Matrices are row-major [N x N].
#include "shared/real.h"
#ifndef EIGEN_N  // the file by itself, for the syntax check
#define EIGEN_N 3
#endif
#define EIGEN_JOIN_(a, b) a##b
#define EIGEN_JOIN(a, b) EIGEN_JOIN_(a, b)

// On return A is diagonal (to rounding) with the eigenvalues, V holds the eigenvectors as columns: A_in = V A V^T.
static inline void EIGEN_JOIN(symmetric_eigen_, EIGEN_N)(real* A, real* V) {
  for (int i = 0; i < EIGEN_N; ++i)
    for (int j = 0; j < EIGEN_N; ++j) V[i * EIGEN_N + j] = i == j ? 1 : 0;
  // Jacobi converges quadratically: 6 sweeps do for doubles, the bound is for safety
  for (int sweep = 0; sweep < 16; ++sweep) {
    real off = 0, all = 0;
    for (int i = 0; i < EIGEN_N; ++i)
      for (int j = 0; j < EIGEN_N; ++j) {
        const real square = A[i * EIGEN_N + j] * A[i * EIGEN_N + j];
        all += square;
        if (i != j) off += square;
      }
    if (off <= 1e-32 * all) break;
    for (int p = 0; p < EIGEN_N - 1; ++p)
      for (int q = p + 1; q < EIGEN_N; ++q) {
        const real apq = A[p * EIGEN_N + q];
        if (apq == 0) continue;
        // tan of the rotation that clears A_pq, the smaller root
        const real theta = (A[q * EIGEN_N + q] - A[p * EIGEN_N + p]) / (2 * apq);
        const real t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
        const real c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < EIGEN_N; ++k) {
          const real akp = A[k * EIGEN_N + p], akq = A[k * EIGEN_N + q];
          A[k * EIGEN_N + p] = c * akp - s * akq;
          A[k * EIGEN_N + q] = s * akp + c * akq;
        }
        for (int k = 0; k < EIGEN_N; ++k) {
          const real apk = A[p * EIGEN_N + k], aqk = A[q * EIGEN_N + k];
          A[p * EIGEN_N + k] = c * apk - s * aqk;
          A[q * EIGEN_N + k] = s * apk + c * aqk;
        }
        for (int k = 0; k < EIGEN_N; ++k) {
          const real vkp = V[k * EIGEN_N + p], vkq = V[k * EIGEN_N + q];
          V[k * EIGEN_N + p] = c * vkp - s * vkq;
          V[k * EIGEN_N + q] = s * vkp + c * vkq;
        }
      }
  }
}

// A becomes V max(Lambda, 0) V^T, exactly symmetric.
static inline void EIGEN_JOIN(project_to_psd_, EIGEN_N)(real* A) {
  real D[EIGEN_N * EIGEN_N], V[EIGEN_N * EIGEN_N];
  for (int k = 0; k < EIGEN_N * EIGEN_N; ++k) D[k] = A[k];
  EIGEN_JOIN(symmetric_eigen_, EIGEN_N)(D, V);
  for (int i = 0; i < EIGEN_N; ++i)
    for (int j = i; j < EIGEN_N; ++j) {
      real sum = 0;
      for (int k = 0; k < EIGEN_N; ++k) sum += V[i * EIGEN_N + k] * fmax(D[k * EIGEN_N + k], 0.0) * V[j * EIGEN_N + k];
      A[i * EIGEN_N + j] = sum;
      A[j * EIGEN_N + i] = sum;
    }
}
#undef EIGEN_N
#undef EIGEN_JOIN
#undef EIGEN_JOIN_
