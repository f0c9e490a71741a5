// What the material of a tetrahedron with 4 nodes adds to its elasticity:  E = V psi(F)                            [J]
// psi: green_strain.cl, F: tetrahedron.cl
#include "energies/elastic/green_strain.cl"
#include "energies/elastic/strain_effect_4.h"
#include "energies/elastic/tetrahedron.cl"

static inline real strain_effect_4_energy(const StrainEffect4 p, const real3* x, const real3* x0, const real h) {
  const StrainLaw law = STRAIN_LAW_OF(p);
  real sum = 0;
  real3 b[4];
  tetrahedron_4_gradients(p.rest_inverse, b);
  const Mat3 e = green_strain(tetrahedron_deformation(4, x, b));
  sum += strain_density(law, e, green_strain(tetrahedron_deformation(4, x0, b)), h);
  return p.volume * sum;
}

static inline void strain_effect_4_gradient(const StrainEffect4 p, const real3* x, const real3* x0, const real h,
                                            real3* g) {
  const StrainLaw law = STRAIN_LAW_OF(p);
  for (int a = 0; a < 4; ++a) g[a] = (real3)(0, 0, 0);
  real3 b[4];
  tetrahedron_4_gradients(p.rest_inverse, b);
  const Mat3 e0 = green_strain(tetrahedron_deformation(4, x0, b));
  const Mat3 stress = strain_stress(law, tetrahedron_deformation(4, x, b), e0, h);
  for (int a = 0; a < 4; ++a) g[a] += p.volume * mat3_times(stress, b[a]);
}

static inline void strain_effect_4_hessian(const StrainEffect4 p, const real3* x, const real3* x0, const real h,
                                           global real* H) {
  const StrainLaw law = STRAIN_LAW_OF(p);
  for (int k = 0; k < n_upper_numbers(4); ++k) H[k] = 0;
  real3 b[4];
  tetrahedron_4_gradients(p.rest_inverse, b);
  const Mat3 e0 = green_strain(tetrahedron_deformation(4, x0, b));
  strain_add_hessian(law, tetrahedron_deformation(4, x, b), e0, h, p.volume, 4, b, H);
}

#define TERM strain_effect_4
#define PARAMS StrainEffect4
#define STENCIL 4
#define HESSIAN_IN_PLACE
#include "energies/assemble.cl"
