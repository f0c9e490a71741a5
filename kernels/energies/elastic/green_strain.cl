// What a tetrahedron's material may add to its elasticity, by the Green strain E = (F^T F - 1) / 2, E0 at the start of
// the step, D = E - E0:
//   psi = mu beta (E:E)^2                      stiffening: S = 4 mu beta (E:E) E
//       + eta |D|^2 / h                        viscosity:  S = 2 eta dE/dt
//       + 2 mu chi |E0| f0(|D|)                hysteresis: S = 2 mu chi |E| D / |D|, alike at every rate
// in Pa. |.| is the Frobenius norm, f0: smooth_coulomb.cl. S = dpsi/dE is the second Piola-Kirchhoff stress, F S the
// first. Hessian: d2psi/dE2 carried to the sites (Gauss-Newton); what the stress itself contributes is dropped, which
// keeps it positive semi-definite.
#ifndef PVG_ENERGIES_GREEN_STRAIN_CL
#define PVG_ENERGIES_GREEN_STRAIN_CL
#include "energies/contact/smooth_coulomb.cl"
#include "energies/upper_blocks.cl"
#include "shared/mat3.cl"

typedef struct {
  real stiffening;   // mu beta [Pa]
  real viscosity;    // eta [Pa s]
  real hysteresis;   // 2 mu chi [Pa]
  real strain_rate;  // where hysteresis is fully developed [1/s]
} StrainLaw;

#define STRAIN_LAW_OF(p) \
  { (p).stiffening, (p).viscosity, (p).hysteresis, (p).strain_rate }

static inline Mat3 green_strain(const Mat3 f) {
  Mat3 e;
  for (int k = 0; k < 3; ++k) e.column[k] = 0.5 * mat3_transposed_times(f, f.column[k]);
  e.column[0].x -= 0.5;
  e.column[1].y -= 0.5;
  e.column[2].z -= 0.5;
  return e;
}

static inline Mat3 mat3_minus(const Mat3 a, const Mat3 b) { return mat3_plus(a, mat3_scaled(b, -1)); }

// psi [Pa] at strain e from e0
static inline real strain_density(const StrainLaw law, const Mat3 e, const Mat3 e0, const real h) {
  const real square = mat3_square_norm(e), change = mat3_square_norm(mat3_minus(e, e0));
  real psi = law.stiffening * square * square + law.viscosity / h * change;
  if (law.hysteresis > 0)
    psi += law.hysteresis * sqrt(mat3_square_norm(e0)) * smooth_coulomb(sqrt(change), law.strain_rate * h);
  return psi;
}

// d2psi/dE2 = same 1 + strain E E^T + less D D^T, and S = stiff E + over D
typedef struct {
  real stiff, over, same, strain, less;  // [Pa]
} StrainDerivatives;

static inline StrainDerivatives strain_derivatives(const StrainLaw law, const Mat3 e, const Mat3 e0, const real h) {
  const real y = sqrt(mat3_square_norm(mat3_minus(e, e0))), eps = law.strain_rate * h;
  const real dry = law.hysteresis > 0 ? law.hysteresis * sqrt(mat3_square_norm(e0)) : 0;
  StrainDerivatives d;
  d.stiff = 4 * law.stiffening * mat3_square_norm(e);
  d.over = 2 * law.viscosity / h + (dry > 0 ? dry * smooth_coulomb_slope_over(y, eps) : 0);
  d.same = d.stiff + d.over;
  d.strain = 8 * law.stiffening;
  d.less = dry > 0 ? -dry * smooth_coulomb_less_along(y, eps) : 0;
  return d;
}

// first Piola-Kirchhoff stress [Pa]
static inline Mat3 strain_stress(const StrainLaw law, const Mat3 f, const Mat3 e0, const real h) {
  const Mat3 e = green_strain(f);
  const StrainDerivatives d = strain_derivatives(law, e, e0, h);
  const Mat3 s = mat3_plus(mat3_scaled(e, d.stiff), mat3_scaled(mat3_minus(e, e0), d.over));
  return mat3_of_columns(mat3_times(f, s.column[0]), mat3_times(f, s.column[1]), mat3_times(f, s.column[2]));
}

// H += weight d2psi/dx dx for F = sum_a x_a b_a^T. For dF = dx b^T: |dE|^2 is half of |F^T dF|^2 + F^T dF : dF^T F, and
// E:dE = dx . (F E b).  b: [n <= 10, 1/m];  H: its blocks on and above the diagonal (upper_blocks.cl) are added to
static inline void strain_add_hessian(const StrainLaw law, const Mat3 f, const Mat3 e0, const real h, const real weight,
                                      const int n, const real3* b, global real* H) {
  const Mat3 e = green_strain(f), change = mat3_minus(e, e0);
  const StrainDerivatives d = strain_derivatives(law, e, e0, h);
  const real same = 0.5 * weight * d.same, strain = weight * d.strain, less = weight * d.less;
  Mat3 square;  // F F^T
  const Mat3 t = mat3_transposed(f);
  for (int k = 0; k < 3; ++k) square.column[k] = mat3_times(f, t.column[k]);
  real3 stretched[10], strained[10], changed[10];  // F b, F E b, F D b
  for (int i = 0; i < n; ++i) {
    stretched[i] = mat3_times(f, b[i]);
    strained[i] = mat3_times(f, mat3_times(e, b[i]));
    changed[i] = mat3_times(f, mat3_times(change, b[i]));
  }
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) {
      Mat3 block = mat3_scaled(
          mat3_plus(mat3_scaled(square, dot(b[i], b[j])), mat3_outer(stretched[j], stretched[i])), same);
      if (strain != 0) block = mat3_plus(block, mat3_scaled(mat3_outer(strained[i], strained[j]), strain));
      if (less != 0) block = mat3_plus(block, mat3_scaled(mat3_outer(changed[i], changed[j]), less));
      for (int k = 0; k < 3; ++k) {
        H[upper_block(n, i, j) + k] += block.column[k].x;
        H[upper_block(n, i, j) + 3 + k] += block.column[k].y;
        H[upper_block(n, i, j) + 6 + k] += block.column[k].z;
      }
    }
}

#endif
