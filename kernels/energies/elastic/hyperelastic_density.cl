// What rubber's energy density adds to the stable neo-Hookean one, by the deformation gradient F: I = |F|^2, J = det F,
// y = J^(-2/3) I - 3, s_i the principal stretches, t_i = (J^(-1/3) s_i)^exponent                              [J/m^3]
//   Yeoh 1993:  yeoh_2 y^2 + yeoh_3 y^3      beside C10 (I - 3) with C10 = mu/2
//   Ogden 1972: 2 ogden / exponent^2 (t_1 + t_2 + t_3 - 3), which adds `ogden` to the shear modulus
//   logarithm (I/6 - 1/2 - 2/3 log((I + 1)/4) - (J - 1)^2/12): what makes of the stable neo-Hookean density without the
//     optional logarithm of Smith, De Goes, Kim 2018 that with it, of the same Lame parameters, if logarithm = mu
// All numbers but the exponent in Pa. The first two are isochoric: a change of volume costs nothing.
#ifndef PVG_ENERGIES_HYPERELASTIC_DENSITY_CL
#define PVG_ENERGIES_HYPERELASTIC_DENSITY_CL
#include "energies/elastic/isotropic.cl"

typedef struct {
  real yeoh_2, yeoh_3, ogden, exponent, logarithm;
} HyperelasticLaw;

#define HYPERELASTIC_LAW_OF(p) \
  { (p).yeoh_2, (p).yeoh_3, (p).ogden, (p).exponent, (p).logarithm }

// By F - 1, so that what cancels at rest is cancelled by hand. Infinite where J <= 0.
static inline real hyperelastic_density(const Mat3 f, const HyperelasticLaw law) {
  const Mat3 g = mat3_plus(f, mat3_scaled(mat3_identity(), -1));
  const Mat3 cofactor = mat3_cofactor(g);
  const real trace = g.column[0].x + g.column[1].y + g.column[2].z;
  const real change = trace + cofactor.column[0].x + cofactor.column[1].y + cofactor.column[2].z +
                      mat3_determinant(g);  // J - 1
  if (!(change > -1)) return INFINITY;      // NaN as well
  const real more = mat3_square_norm(g) + 2 * trace, log_volume = log1p(change);  // I - 3, log J
  const real y = more + expm1(-2.0 / 3 * log_volume) * (more + 3);
  real psi = (law.yeoh_2 + law.yeoh_3 * y) * y * y;
  psi += law.logarithm * (more / 6 - 2.0 / 3 * log1p(more / 4) - change * change / 12);
  if (law.ogden != 0) {
    const Svd3 svd = svd3(f);
    const real mean = log_volume / 3;
    const real sum = expm1(law.exponent * (log(svd.sigma.x) - mean)) + expm1(law.exponent * (log(svd.sigma.y) - mean)) +
                     expm1(law.exponent * (log(svd.sigma.z) - mean));
    psi += 2 * law.ogden / (law.exponent * law.exponent) * sum;
  }
  return psi;
}

// dPsi/dF [Pa]
static inline Mat3 hyperelastic_stress(const Mat3 f, const HyperelasticLaw law) {
  const real J = mat3_determinant(f), I = mat3_square_norm(f), isochoric = exp(-2.0 / 3 * log(J)), y = isochoric * I - 3;
  const real by_y = (2 * law.yeoh_2 + 3 * law.yeoh_3 * y) * y;
  const real by_i = by_y * isochoric + law.logarithm * (1.0 / 6 - 2.0 / 3 / (I + 1));
  const real by_j = -2.0 / 3 * by_y * isochoric * I / J - law.logarithm * (J - 1) / 6;
  Mat3 stress = mat3_plus(mat3_scaled(f, 2 * by_i), mat3_scaled(mat3_cofactor(f), by_j));
  if (law.ogden != 0) {
    const Svd3 svd = svd3(f);
    const real mean = log(J) / 3;
    const real3 t = (real3)(exp(law.exponent * (log(svd.sigma.x) - mean)), exp(law.exponent * (log(svd.sigma.y) - mean)),
                            exp(law.exponent * (log(svd.sigma.z) - mean)));
    const real3 by_stretch = 2 * law.ogden / law.exponent * (t - (t.x + t.y + t.z) / 3) / svd.sigma;
    stress = mat3_plus(stress, mat3_outer(svd.u.column[0], by_stretch.x * svd.v.column[0]));
    stress = mat3_plus(stress, mat3_outer(svd.u.column[1], by_stretch.y * svd.v.column[1]));
    stress = mat3_plus(stress, mat3_outer(svd.u.column[2], by_stretch.z * svd.v.column[2]));
  }
  return stress;
}

// of N_LANES elements
typedef struct {
  lanes yeoh_2, yeoh_3, ogden, exponent, logarithm;
} HyperelasticLanes;

#define SET_HYPERELASTIC_LANES(law, n_elements, p)      \
  SET_LANES(law.yeoh_2, n_elements, p[e].yeoh_2);       \
  SET_LANES(law.yeoh_3, n_elements, p[e].yeoh_3);       \
  SET_LANES(law.ogden, n_elements, p[e].ogden);         \
  SET_LANES(law.exponent, n_elements, p[e].exponent);   \
  SET_LANES(law.logarithm, n_elements, p[e].logarithm)

// Adds what the principal stretches of Ogden's term contribute. Where two stretches are nearly equal, flip is its limit
// A_ii - A_ij, of which the mean over both is right to second order.
static inline void ogden_add_hessian(const lanes s[3], const HyperelasticLanes* law, IsotropicHessian* e) {
  const lanes a = law->exponent, mean = log(s[0] * s[1] * s[2]) / 3;
  lanes t[3], first[3], second[3][3];
  for (int i = 0; i < 3; ++i) t[i] = exp(a * (log(s[i]) - mean));
  const lanes mean_t = (t[0] + t[1] + t[2]) / 3, scale = 2 * law->ogden / a;
  for (int i = 0; i < 3; ++i) first[i] = scale * (t[i] - mean_t) / s[i];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      lanes sum = a * (mean_t - t[i] - t[j]) / 3;
      if (i == j) sum += a * t[i] - (t[i] - mean_t);
      second[i][j] = scale * sum / (s[i] * s[j]);
      e->stretch[i][j] += second[i][j];
    }
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const lanes sum = s[i] + s[j], between = s[i] - s[j];
    const lane_mask is_apart = fabs(between) > 1e-5 * sum;
    const lanes limit = 0.5 * (second[i][i] + second[j][j]) - second[i][j];
    e->twist[k] += (first[i] + first[j]) / sum;
    e->flip[k] += is_apart ? (first[i] - first[j]) / (is_apart ? between : (lanes)(1)) : limit;
  }
}

// d2Psi/dF2, positive semi-definite [Pa].  f: [column][row], J > 0
static inline void hyperelastic_hessian(const lanes f[3][3], const HyperelasticLanes* law, IsotropicHessian* e) {
  lanes_svd3(f, &e->svd);
  const lanes* s = e->svd.sigma;
  const lanes J = s[0] * s[1] * s[2], I = s[0] * s[0] + s[1] * s[1] + s[2] * s[2], isochoric = exp(-2.0 / 3 * log(J));
  const lanes y = isochoric * I - 3, y_j = -2.0 / 3 * isochoric * I / J;  // dy/dI = isochoric
  const lanes by_y = (2 * law->yeoh_2 + 3 * law->yeoh_3 * y) * y, by_yy = 2 * law->yeoh_2 + 6 * law->yeoh_3 * y;
  const lanes inverse = 1 / (I + 1);
  const lanes by_i = by_y * isochoric + law->logarithm * (1.0 / 6 - 2.0 / 3 * inverse);
  const lanes by_j = by_y * y_j - law->logarithm * (J - 1) / 6;
  const lanes by_ii = by_yy * isochoric * isochoric + 2.0 / 3 * law->logarithm * inverse * inverse;
  const lanes by_ij = by_yy * isochoric * y_j - 2.0 / 3 * by_y * isochoric / J;
  const lanes by_jj = by_yy * y_j * y_j - 5.0 / 3 * by_y * y_j / J - law->logarithm / 6;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const lanes of_k = s[i] * s[j], of_i = s[j] * s[k], of_j = s[k] * s[i];  // dJ/ds
    e->stretch[k][k] = 2 * by_i + 4 * by_ii * s[k] * s[k] + 4 * by_ij * J + by_jj * of_k * of_k;
    e->stretch[i][j] = e->stretch[j][i] = by_j * s[k] + 4 * by_ii * of_k + 2 * by_ij * (s[i] * of_j + s[j] * of_i) +
                                          by_jj * of_i * of_j;
    e->twist[k] = 2 * by_i + by_j * s[k];
    e->flip[k] = 2 * by_i - by_j * s[k];
  }
  const lane_mask has_ogden = law->ogden != 0;
  if (ANY_LANE(has_ogden)) ogden_add_hessian(s, law, e);
  isotropic_project(e);
}

#endif
