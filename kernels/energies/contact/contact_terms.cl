// Contact and friction of all pairs in contact, in one launch each. How many contacts there are only the device knows
// when these are started: first[n_worlds], and work-items beyond do nothing.
#define TERM_FUNCTIONS_ONLY
#include "energies/contact/barrier.cl"
#include "energies/contact/friction.cl"

// n: n_friction, rounded up to whole work-groups, and the most contacts that there may be
// first: [n_worlds + 1] contacts of each world;  x, x0: sites [n_sites x 3, m];  h [s]
// energy: [J] of friction from number first_friction on, of contacts behind it
kernel void contact_energy(const uint n, const uint n_friction, const uint n_worlds, global const uint* restrict first,
                           global const Friction* restrict friction, global const Barrier* restrict contacts,
                           global const real* restrict x, global const real* restrict x0, const real h,
                           const uint first_friction, global real* restrict energy) {
  const uint i = get_global_id(0), n_friction_items = (n_friction + 63) / 64 * 64;
  if (i >= n) return;
  if (i < n_friction)
    friction_energy_of(i, friction, x, x0, h, first_friction, energy);
  else if (i >= n_friction_items && i - n_friction_items < first[n_worlds])
    barrier_energy_of(i - n_friction_items, contacts, x, x0, h, first_friction + n_friction, energy);
}

// Gradient rows, of the contacts from row first_row on and of friction behind them, and the 12 x 12 Hessian blocks of
// each kind. n: n_friction, rounded up as above, and n_contacts
kernel void contact_derivatives(const uint n, const uint n_friction, const uint n_contacts,
                                global const Friction* restrict friction, global const Barrier* restrict contacts,
                                global const real* restrict x, global const real* restrict x0, const real h,
                                const uint first_row, global real* restrict rows, global real* restrict contact_blocks,
                                global real* restrict friction_blocks) {
  const uint i = get_global_id(0), n_friction_items = (n_friction + 63) / 64 * 64;
  if (i >= n) return;
  if (i < n_friction) {
    friction_gradient_of(i, friction, x, x0, h, first_row + 4 * n_contacts, rows);
    friction_hessian_of(i, friction, x, x0, h, 0, friction_blocks);
  } else if (i >= n_friction_items) {
    barrier_gradient_of(i - n_friction_items, contacts, x, x0, h, first_row, rows);
    barrier_hessian_of(i - n_friction_items, contacts, x, x0, h, 0, contact_blocks);
  }
}
