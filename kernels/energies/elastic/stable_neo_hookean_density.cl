// Stable neo-Hookean energy density of a deformation gradient F, J = det F:
//   Psi = mu/2 (|F|^2 - 3) + lambda'/2 (J - 1 - mu/lambda')^2 - mu^2/(2 lambda'),   lambda' = lambda + mu      [J/m^3]
// Smith, De Goes, Kim 2018, "Stable Neo-Hookean Flesh Simulation". mu and lambda are the Lame parameters that a small
// deformation shows [Pa]; lambda' is the exact remap that makes it so. The last summand makes Psi(1) = 0.
#ifndef PVG_ENERGIES_STABLE_NEO_HOOKEAN_DENSITY_CL
#define PVG_ENERGIES_STABLE_NEO_HOOKEAN_DENSITY_CL
#include "energies/elastic/isotropic.cl"

// In terms of F - 1, where the large summands that cancel at rest have been cancelled by hand. Infinite where J <= 0:
// the line search refuses an inverted element.
static inline real stable_neo_hookean_density(const Mat3 f, const real mu, const real lambda) {
  const Mat3 g = mat3_plus(f, mat3_scaled(mat3_identity(), -1));
  const Mat3 cofactor = mat3_cofactor(g);
  // J - 1 = tr G + II(G) + det G, and |F|^2 - 3 = |G|^2 + 2 tr G
  const real second = cofactor.column[0].x + cofactor.column[1].y + cofactor.column[2].z + mat3_determinant(g);
  const real change = g.column[0].x + g.column[1].y + g.column[2].z + second;  // J - 1
  if (!(change > -1)) return INFINITY;                                         // NaN as well
  return 0.5 * mu * mat3_square_norm(g) - mu * second + 0.5 * (lambda + mu) * change * change;
}

// dPsi/dF [Pa]
static inline Mat3 stable_neo_hookean_stress(const Mat3 f, const real mu, const real lambda) {
  const real c = (lambda + mu) * (mat3_determinant(f) - 1) - mu;
  return mat3_plus(mat3_scaled(f, mu), mat3_scaled(mat3_cofactor(f), c));
}

// d2Psi/dF2, positive semi-definite, of N_LANES elements [Pa].  f: [column][row]
static inline void stable_neo_hookean_hessian(const lanes f[3][3], const lanes mu, const lanes lambda,
                                              IsotropicHessian* e) {
  lanes_svd3(f, &e->svd);
  const lanes* sigma = e->svd.sigma;
  const lanes stiffened = lambda + mu, J = sigma[0] * sigma[1] * sigma[2];
  const lanes c = stiffened * (J - 1) - mu, d = stiffened * (2 * J - 1) - mu;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const lanes area = sigma[i] * sigma[j];
    e->stretch[k][k] = mu + stiffened * area * area;
    e->stretch[i][j] = e->stretch[j][i] = d * sigma[k];
    e->twist[k] = mu + c * sigma[k];
    e->flip[k] = mu - c * sigma[k];
  }
  isotropic_project(e);
}

#endif
