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
  const Svd3 s = svd3(mat3_of_columns(a[0], a[1], a[2]));
  const real3 square = s.sigma * s.sigma;
  const real3 product = (real3)(s.sigma.y * s.sigma.z, s.sigma.z * s.sigma.x, s.sigma.x * s.sigma.y);
  const real3 others = (real3)(square.y + square.z, square.z + square.x, square.x + square.y);
  IsotropicHessian e;
  e.u = s.u;
  e.v = s.v;
  e.stretch = mat3_of_columns((real3)(12 * square.x - 4, 0, 0), (real3)(0, 12 * square.y - 4, 0),
                              (real3)(0, 0, 12 * square.z - 4));
  e.twist = 4 * (others - product - 1);
  e.flip = 4 * (others + product - 1);
  isotropic_project(&e);
  const real3 axes[3] = {(real3)(1, 0, 0), (real3)(0, 1, 0), (real3)(0, 0, 1)};
  for (int k = 0; k < 81; ++k) H[k] = 0;
  isotropic_add_hessian(e, p.stiffness, 3, axes, H);
  mirror_upper_in_place(9, H);
}

#define TERM affine_orthogonality
#define PARAMS AffineOrthogonality
#define STENCIL 3
#define HESSIAN_IN_PLACE
#include "energies/assemble.cl"
