// What rubber adds to a stable neo-Hookean tetrahedron with 4 nodes:  E = V psi(F)                               [J]
// psi: hyperelastic_density.cl, F: tetrahedron.cl
#include "energies/elastic/hyperelastic_4.h"
#include "energies/elastic/hyperelastic_density.cl"
#include "energies/elastic/tetrahedron.cl"

static inline real hyperelastic_4_energy(const Hyperelastic4 p, const real3* x, const real3* x0, const real h) {
  const HyperelasticLaw law = HYPERELASTIC_LAW_OF(p);
  real3 b[4];
  tetrahedron_4_gradients(p.rest_inverse, b);
  return p.volume * hyperelastic_density(tetrahedron_deformation(4, x, b), law);
}

static inline void hyperelastic_4_gradient(const Hyperelastic4 p, const real3* x, const real3* x0, const real h,
                                           real3* g) {
  const HyperelasticLaw law = HYPERELASTIC_LAW_OF(p);
  real3 b[4];
  tetrahedron_4_gradients(p.rest_inverse, b);
  const Mat3 stress = hyperelastic_stress(tetrahedron_deformation(4, x, b), law);
  for (int a = 0; a < 4; ++a) g[a] = p.volume * mat3_times(stress, b[a]);
}

// of the n_elements <= N_LANES elements from p on
static inline void hyperelastic_4_hessian_of_lanes(const uint n_elements, global const Hyperelastic4* p,
                                                   global const real* x, global real* H) {
  lanes at[4][3], rest_inverse[9], volume;
  HyperelasticLanes law;
  for (int s = 0; s < 4; ++s)
    for (int k = 0; k < 3; ++k) SET_LANES(at[s][k], n_elements, x[3 * p[e].site[s] + k]);
  for (int k = 0; k < 9; ++k) SET_LANES(rest_inverse[k], n_elements, p[e].rest_inverse[k]);
  SET_LANES(volume, n_elements, p[e].volume);
  SET_HYPERELASTIC_LANES(law, n_elements, p);
  lanes b[4][3], f[3][3];
  UPPER_SUM(sum, 4, H);
  lanes_tetrahedron_4_gradients(rest_inverse, b);
  lanes_tetrahedron_deformation(4, at, b, f);
  IsotropicHessian hessian;
  hyperelastic_hessian(f, &law, &hessian);
  clear_upper(4, sum);
  isotropic_add_hessian(&hessian, volume, 4, b, sum);
  store_upper(4, n_elements, sum, H);
}

#define TERM hyperelastic_4
#define PARAMS Hyperelastic4
#define STENCIL 4
#define HESSIAN_OF_LANES
#include "energies/assemble.cl"
