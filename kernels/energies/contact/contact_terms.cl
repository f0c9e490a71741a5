// Contact and friction of all pairs, in one launch each.
#define TERM_FUNCTIONS_ONLY
#include "contact/activity.cl"
#include "energies/contact/barrier.cl"
#include "energies/contact/primal_dual_friction.cl"

// Of all candidates, 0 where they are too far apart: contacts are found from is_active and counts afterwards, as
// contact/contact.cl does with pair_gaps.
// n: n_friction, rounded up to whole work-groups, and the candidates;  x, x0: sites [n_sites x 3, m];  h [s]
// energy: [J] of friction from number first_friction on, of candidates behind it
// is_active: [n_candidates] 1 where it exerts a force;  counts: of the active ones of each 64
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void contact_energy(
    const uint n, const uint n_friction, global const Friction* restrict friction,
    global const Barrier* restrict candidates, global const real* restrict x, global const real* restrict x0,
    const real h, const uint first_friction, global real* restrict energy, global uint* restrict is_active,
    global uint* restrict counts) {
  local uint count;
  const uint i = get_global_id(0), n_friction_items = (n_friction + 63) / 64 * 64;
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
  const uint n_active = count_active(exerts_force, &count);
  if (get_local_id(0) == 0 && i >= n_friction_items) counts[(i - n_friction_items) / 64] = n_active;
}

// Gradient rows, of the contacts from row first_row on and of friction behind them, and the 12 x 12 Hessian blocks of
// each kind. n: n_friction, rounded up as above, and n_contacts;  begins, dual: as in primal_dual_friction.cl
kernel void contact_derivatives(const uint n, const uint n_friction, const uint n_contacts,
                                global const Friction* restrict friction, global const Barrier* restrict contacts,
                                global const real* restrict x, global const real* restrict x0, const real h,
                                const uint first_row, global real* restrict rows, global real* restrict contact_blocks,
                                global real* restrict friction_blocks, const uint begins,
                                global FrictionDual* restrict dual) {
  const uint i = get_global_id(0), n_friction_items = (n_friction + 63) / 64 * 64;
  if (i >= n) return;
  if (i < n_friction) {
    friction_gradient_of(i, friction, x, x0, h, first_row + 4 * n_contacts, rows);
    primal_dual_friction_hessian_of(i, friction, x, x0, h, begins, dual, friction_blocks);
  } else if (i >= n_friction_items) {
    barrier_gradient_of(i - n_friction_items, contacts, x, x0, h, first_row, rows);
    barrier_hessian_of(i - n_friction_items, contacts, x, x0, h, 0, contact_blocks);
  }
}
