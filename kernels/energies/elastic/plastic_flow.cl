// What a tetrahedron's rest shape becomes after a step, F = U diag(sigma) V^T the deformation of its corners:
//   e = dev log sigma;   creep: e <- e exp(-rate h);   yield: e <- e min(1, yield / |e|)
//   Dm^-1 <- Dm^-1 V diag(exp(e_new - e_old)) V^T      so that F <- U diag(sigma exp(e_new - e_old)) V^T
// The volume stays, for e has no trace. Simo 1992, "Algorithms for static and dynamic multiplicative plasticity": the
// return in principal logarithmic strains.
#include "energies/elastic/plastic_flow.h"
#include "energies/elastic/stable_neo_hookean_10.h"
#include "energies/elastic/stable_neo_hookean_4.h"
#include "shared/svd.cl"

static inline void flow(const PlasticFlow p, global const u32* site, global real* rest_inverse, global const real* x,
                        const real h) {
  Mat3 shape, inverse;  // columns: edges; rows of Dm^-1
  const real3 x0 = vload3(site[0], x);
  for (int k = 0; k < 3; ++k) {
    shape.column[k] = vload3(site[k + 1], x) - x0;
    inverse.column[k] = (real3)(rest_inverse[k], rest_inverse[3 + k], rest_inverse[6 + k]);
  }
  Mat3 f;
  for (int k = 0; k < 3; ++k) f.column[k] = mat3_times(shape, inverse.column[k]);
  const Svd3 s = svd3(f);
  if (!(s.sigma.z > 0)) return;
  const real3 strain = (real3)(log(s.sigma.x), log(s.sigma.y), log(s.sigma.z));
  const real3 deviator = strain - (strain.x + strain.y + strain.z) / 3;
  real left = exp(-p.rate * h);
  const real size = left * length(deviator);
  if (p.yield_strain > 0 && size > p.yield_strain) left *= p.yield_strain / size;
  if (left == 1) return;
  const real3 factor = exp((left - 1) * deviator);
  const Mat3 v = s.v, t = mat3_transposed(s.v);
  // V diag(factor) V^T, then Dm^-1 times it, column by column
  for (int k = 0; k < 3; ++k) {
    const real3 column = mat3_times(inverse, mat3_times(v, factor * t.column[k]));
    rest_inverse[k] = column.x;
    rest_inverse[3 + k] = column.y;
    rest_inverse[6 + k] = column.z;
  }
}

// flows: [n];  elements: of the term;  world_steps: [n_worlds] 1 where a step was done;  x: sites at its end [m]
#define FLOW_KERNEL(NAME, ELEMENT)                                                                        \
  kernel void NAME(const uint n, global const PlasticFlow* restrict flows, global ELEMENT* elements,      \
                   global const u32* restrict world_steps, global const real* restrict x, const real h) { \
    const uint i = get_global_id(0);                                                                      \
    if (i >= n || !world_steps[flows[i].world]) return;                                                   \
    global ELEMENT* element = elements + flows[i].element;                                                \
    flow(flows[i], element->site, element->rest_inverse, x, h);                                           \
  }
FLOW_KERNEL(plastic_flow_4, StableNeoHookean4)
FLOW_KERNEL(plastic_flow_10, StableNeoHookean10)
