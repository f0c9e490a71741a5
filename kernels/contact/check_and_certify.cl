// Whether candidates serve for a motion, and how much of it is free of contact, in one launch: neither waits for the
// other.
#include "contact/accd.cl"
#include "contact/serves.cl"

// n: 64 x work-groups, n_checking for the lists, then one for each 64 pairs.  The rest as of contact/lists_serve.cl
// and contact/accd_steps.cl
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void check_and_certify(
    const uint n, const uint n_checking, const uint n_solids, global const u32* restrict first_solid,
    global const u32* restrict sites_solid, global const real* restrict reference_solid, const uint n_sheets,
    global const u32* restrict first_sheet, global const u32* restrict sites_sheet,
    global const real* restrict reference_sheet, const uint n_surface, global const u32* restrict surface,
    global const real* restrict reference, global const real* restrict x0, global const real* restrict x1,
    const real allowed_solid, const real allowed_sheet, const real allowed, const real most_rotation, const uint no,
    global u32* serves, const uint n_pairs, global const Barrier* restrict pairs, global real* restrict steps,
    global real* restrict of_64) {
  local real lanes[3 * LANES];
  local real turns[2 * 9];
  if (get_group_id(0) < n_checking) {
    check_lists(n_solids, first_solid, sites_solid, reference_solid, n_sheets, first_sheet, sites_sheet,
                reference_sheet, n_surface, surface, reference, x0, x1, allowed_solid, allowed_sheet, allowed,
                most_rotation, no, serves, lanes, turns);
  } else {
    certify_pair(get_global_id(0) - n_checking * LANES, n_pairs, pairs, x0, x1, steps, of_64, lanes);
  }
}
