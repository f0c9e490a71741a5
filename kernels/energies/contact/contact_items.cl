// What one work-item does for contact and friction of all pairs: those of friction come first, in whole work-groups, then
// candidates or contacts. Kernels of contact alone are in contact_terms.cl, with a scene's small terms in
// host/physics/energies/small_terms.cpp.
#ifndef PVG_ENERGIES_CONTACT_ITEMS_CL
#define PVG_ENERGIES_CONTACT_ITEMS_CL
#define TERM_FUNCTIONS_ONLY
#include "contact/activity.cl"
#include "energies/contact/barrier.cl"
#include "energies/contact/primal_dual_friction.cl"

static inline uint whole_groups(const uint n) { return (n + 63) / 64 * 64; }

// The energy of candidates that are too far apart is 0: contacts are found from is_active and counts afterwards, as
// contact/contact.cl does with pair_gaps. Returns whether the item's candidate exerts a force.
// n: n_friction, rounded up to whole work-groups, and the candidates;  x, x0: sites [n_sites x 3, m];  h [s]
// energy: [J] of friction from number first_friction on, of candidates behind it
// is_active: [n_candidates] 1 where it exerts a force
static inline bool contact_energy_of_item(const uint i, const uint n, const uint n_friction,
                                          global const Friction* restrict friction,
                                          global const Barrier* restrict candidates, global const real* restrict x,
                                          global const real* restrict x0, const real h, const uint first_friction,
                                          global real* restrict energy, global uint* restrict is_active) {
  const uint n_friction_items = whole_groups(n_friction);
  bool exerts_force = false;
  if (i < n_friction) friction_energy_of(i, friction, x, x0, h, first_friction, energy);
  if (i >= n_friction_items && i < n) {
    const uint e = i - n_friction_items;
    real3 xe[4];
    for (int s = 0; s < 4; ++s) xe[s] = vload3(candidates[e].site[s], x);
    const real gap = pair_distance(candidates[e].kind, xe).d - candidates[e].offset;
    exerts_force = !(gap >= candidates[e].activation_distance) && candidates[e].area > 0;  // so that NaN shows
    is_active[e] = exerts_force;
    if (exerts_force)
      barrier_energy_of(e, candidates, x, x0, h, first_friction + n_friction, energy);
    else
      energy[first_friction + n_friction + e] = 0;
  }
  return exerts_force;
}

// Gradient rows, of the contacts from row first_row on and of friction behind them, and the 12 x 12 Hessian blocks of
// each kind. n: n_friction, rounded up as above, and n_contacts, the room for contacts, of which there are
// first_contact[n_worlds];  begins, dual: as in primal_dual_friction.cl
static inline void contact_derivatives_of_item(const uint i, const uint n, const uint n_friction, const uint n_contacts,
                                               global const Friction* restrict friction, const uint n_worlds,
                                               global const uint* restrict first_contact,
                                               global const Barrier* restrict contacts, global const real* restrict x,
                                               global const real* restrict x0, const real h, const uint first_row,
                                               global real* restrict rows, global real* restrict contact_blocks,
                                               global real* restrict friction_blocks, const uint begins,
                                               global FrictionDual* restrict dual) {
  const uint n_friction_items = whole_groups(n_friction);
  if (i < n_friction) {
    friction_gradient_of(i, friction, x, x0, h, first_row + 4 * n_contacts, rows);
    primal_dual_friction_hessian_of(i, friction, x, x0, h, begins, dual, friction_blocks);
  } else if (i >= n_friction_items && i < n && i - n_friction_items < first_contact[n_worlds]) {
    barrier_gradient_of(i - n_friction_items, contacts, x, x0, h, first_row, rows);
    barrier_hessian_of(i - n_friction_items, contacts, x, x0, h, 0, contact_blocks);
  }
}

#endif
