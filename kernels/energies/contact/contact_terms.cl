// Contact and friction of all pairs, in one launch each; arguments as in contact_items.cl.
#include "energies/contact/contact_items.cl"

// counts: of the active candidates of each 64
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void contact_energy(
    const uint n, const uint n_friction, global const Friction* restrict friction,
    global const Barrier* restrict candidates, global const real* restrict x, global const real* restrict x0,
    const real h, const uint first_friction, global real* restrict energy, global uint* restrict is_active,
    global uint* restrict counts) {
  local uint count;
  const uint i = get_global_id(0), n_friction_items = whole_groups(n_friction);
  const bool exerts_force =
      contact_energy_of_item(i, n, n_friction, friction, candidates, x, x0, h, first_friction, energy, is_active);
  const uint n_active = count_active(exerts_force, &count);
  if (get_local_id(0) == 0 && i >= n_friction_items) counts[(i - n_friction_items) / 64] = n_active;
}

kernel void contact_derivatives(const uint n, const uint n_friction, const uint n_contacts,
                                global const Friction* restrict friction, const uint n_worlds,
                                global const uint* restrict first_contact, global const Barrier* restrict contacts,
                                global const real* restrict x, global const real* restrict x0, const real h,
                                const uint first_row, global real* restrict rows, global real* restrict contact_blocks,
                                global real* restrict friction_blocks, const uint begins,
                                global FrictionDual* restrict dual) {
  contact_derivatives_of_item(get_global_id(0), n, n_friction, n_contacts, friction, n_worlds, first_contact, contacts, x, x0,
                              h, first_row, rows, contact_blocks, friction_blocks, begins, dual);
}
