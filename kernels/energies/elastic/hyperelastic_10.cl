// What rubber adds to a stable neo-Hookean tetrahedron with 10 nodes:  E = V/4 sum_q psi(F_q)                    [J]
// psi: hyperelastic_density.cl, F: tetrahedron.cl
#include "energies/elastic/hyperelastic_10.h"
#include "energies/elastic/hyperelastic_density.cl"
#include "energies/elastic/tetrahedron.cl"

static inline real hyperelastic_10_energy(const Hyperelastic10 p, const real3* x, const real3* x0, const real h) {
  const HyperelasticLaw law = HYPERELASTIC_LAW_OF(p);
  real sum = 0;
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    tetrahedron_10_gradients(p.rest_inverse, q, b);
    sum += hyperelastic_density(tetrahedron_deformation(10, x, b), law);
  }
  return 0.25 * p.volume * sum;
}

static inline void hyperelastic_10_gradient(const Hyperelastic10 p, const real3* x, const real3* x0, const real h,
                                            real3* g) {
  const HyperelasticLaw law = HYPERELASTIC_LAW_OF(p);
  for (int a = 0; a < 10; ++a) g[a] = (real3)(0, 0, 0);
  for (int q = 0; q < 4; ++q) {
    real3 b[10];
    tetrahedron_10_gradients(p.rest_inverse, q, b);
    const Mat3 stress = mat3_scaled(hyperelastic_stress(tetrahedron_deformation(10, x, b), law), 0.25 * p.volume);
    for (int a = 0; a < 10; ++a) g[a] += mat3_times(stress, b[a]);
  }
}

// of the n_elements <= N_LANES elements from p on
static inline void hyperelastic_10_hessian_of_lanes(const uint n_elements, global const Hyperelastic10* p,
                                                    global const real* x, global real* H) {
  lanes at[10][3], rest_inverse[9], volume;
  HyperelasticLanes law;
  for (int s = 0; s < 10; ++s)
    for (int k = 0; k < 3; ++k) SET_LANES(at[s][k], n_elements, x[3 * p[e].site[s] + k]);
  for (int k = 0; k < 9; ++k) SET_LANES(rest_inverse[k], n_elements, p[e].rest_inverse[k]);
  SET_LANES(volume, n_elements, p[e].volume);
  SET_HYPERELASTIC_LANES(law, n_elements, p);
  lanes l[4][3], b[10][3], f[3][3];
  UPPER_SUM(sum, 10, H);
  lanes_tetrahedron_4_gradients(rest_inverse, l);
  clear_upper(10, sum);
  for (int q = 0; q < 4; ++q) {
    lanes_tetrahedron_10_gradients(l, q, b);
    lanes_tetrahedron_deformation(10, at, b, f);
    IsotropicHessian hessian;
    hyperelastic_hessian(f, &law, &hessian);
    isotropic_add_hessian(&hessian, 0.25 * volume, 10, b, sum);
  }
  store_upper(10, n_elements, sum, H);
}

#define TERM hyperelastic_10
#define PARAMS Hyperelastic10
#define STENCIL 10
#define HESSIAN_OF_LANES
#include "energies/assemble.cl"
