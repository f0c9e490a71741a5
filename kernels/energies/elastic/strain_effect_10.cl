// What the material of a tetrahedron with 10 nodes adds to its elasticity:  E = V/4 sum_q psi(F_q)                 [J]
// psi: green_strain.cl, F: tetrahedron.cl
#include "energies/elastic/green_strain.cl"
#include "energies/elastic/strain_effect_10.h"
#include "energies/elastic/tetrahedron.cl"

static inline real strain_effect_10_energy(const StrainEffect10 p, const real3* x, const real3* x0, const real h) {
  const StrainLaw law = STRAIN_LAW_OF(p);
  real sum = 0;
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    tetrahedron_10_gradients(p.rest_inverse, q, b);
    const Mat3 e = green_strain(tetrahedron_deformation(10, x, b));
    sum += strain_density(law, e, green_strain(tetrahedron_deformation(10, x0, b)), h);
  }
  return 0.25 * p.volume * sum;
}

static inline void strain_effect_10_gradient(const StrainEffect10 p, const real3* x, const real3* x0, const real h,
                                             real3* g) {
  const StrainLaw law = STRAIN_LAW_OF(p);
  for (int a = 0; a < 10; ++a) g[a] = (real3)(0, 0, 0);
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    tetrahedron_10_gradients(p.rest_inverse, q, b);
    const Mat3 e0 = green_strain(tetrahedron_deformation(10, x0, b));
    const Mat3 stress = strain_stress(law, tetrahedron_deformation(10, x, b), e0, h);
    for (int a = 0; a < 10; ++a) g[a] += 0.25 * p.volume * mat3_times(stress, b[a]);
  }
}

static inline void strain_effect_10_hessian(const StrainEffect10 p, const real3* x, const real3* x0, const real h,
                                            global real* H) {
  const StrainLaw law = STRAIN_LAW_OF(p);
  for (int k = 0; k < n_upper_numbers(10); ++k) H[k] = 0;
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    tetrahedron_10_gradients(p.rest_inverse, q, b);
    const Mat3 e0 = green_strain(tetrahedron_deformation(10, x0, b));
    strain_add_hessian(law, tetrahedron_deformation(10, x, b), e0, h, 0.25 * p.volume, 10, b, H);
  }
}

#define TERM strain_effect_10
#define PARAMS StrainEffect10
#define STENCIL 10
#define HESSIAN_IN_PLACE
#include "energies/assemble.cl"
