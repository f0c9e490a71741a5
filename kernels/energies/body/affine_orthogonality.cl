// Orthogonality of an affine body:  E = k |A^T A - 1|^2   (Frobenius)                                             [J]
// Lan et al. 2022, "Affine Body Dynamics". A = [a1 a2 a3], dimensionless, so forces on the axes are in joules.
// In singular values E = k sum (sigma_i^2 - 1)^2, hence the closed eigenvalues below.
#include "energies/body/affine_orthogonality.h"
#include "energies/elastic/isotropic.cl"

static inline real affine_orthogonality_energy(const AffineOrthogonality p, const real3* a, const real3* a0,
                                               const real h) {
  real sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const real defect = dot(a[i], a[j]) - (i == j ? 1 : 0);
      sum += defect * defect;
    }
  return p.stiffness * sum;
}

// 4 k A (A^T A - 1)
static inline void affine_orthogonality_gradient(const AffineOrthogonality p, const real3* a, const real3* a0,
                                                 const real h, real3* g) {
  for (int i = 0; i < 3; ++i) {
    real3 sum = (real3)(0, 0, 0);
    for (int j = 0; j < 3; ++j) sum += (dot(a[i], a[j]) - (i == j ? 1 : 0)) * a[j];
    g[i] = 4 * p.stiffness * sum;
  }
}

static inline void affine_orthogonality_hessian(const AffineOrthogonality p, const real3* a, const real3* a0,
                                                const real h, global real* H) {
  lanes f[3][3], axes[3][3];
  UPPER_SUM(sum, 3, H);
  for (int i = 0; i < 3; ++i) {
    f[i][0] = (lanes)(a[i].x);
    f[i][1] = (lanes)(a[i].y);
    f[i][2] = (lanes)(a[i].z);
    for (int k = 0; k < 3; ++k) axes[i][k] = (lanes)(i == k ? 1 : 0);
  }
  IsotropicHessian e;
  lanes_svd3(f, &e.svd);
  const lanes* sigma = e.svd.sigma;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const lanes product = sigma[i] * sigma[j], others = sigma[i] * sigma[i] + sigma[j] * sigma[j];
    e.stretch[k][k] = 12 * sigma[k] * sigma[k] - 4;
    e.stretch[i][j] = e.stretch[j][i] = (lanes)(0);
    e.twist[k] = 4 * (others - product - 1);
    e.flip[k] = 4 * (others + product - 1);
  }
  isotropic_project(&e);
  clear_upper(3, sum);
  isotropic_add_hessian(&e, (lanes)(p.stiffness), 3, axes, sum);
  store_upper(3, 1, sum, H);
}

#define TERM affine_orthogonality
#define PARAMS AffineOrthogonality
#define STENCIL 3
#define HESSIAN_IN_PLACE
#include "energies/assemble.cl"
