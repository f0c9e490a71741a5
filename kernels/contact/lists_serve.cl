// Whether the lists of candidates serve for a motion (contact/serves.cl).
#include "contact/serves.cl"

// n: 64 x work-groups
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void lists_serve(
    const uint n, const uint n_solids, global const u32* restrict first_solid, global const u32* restrict sites_solid,
    global const real* restrict reference_solid, const uint n_sheets, global const u32* restrict first_sheet,
    global const u32* restrict sites_sheet, global const real* restrict reference_sheet, const uint n_surface,
    global const u32* restrict surface, global const real* restrict reference, global const real* restrict x0,
    global const real* restrict x1, const real allowed_solid, const real allowed_sheet, const real allowed,
    const real most_rotation, const uint no, global u32* serves) {
  local real lanes[3 * LANES];
  local real turns[2 * 9];
  check_lists(n_solids, first_solid, sites_solid, reference_solid, n_sheets, first_sheet, sites_sheet, reference_sheet,
              n_surface, surface, reference, x0, x1, allowed_solid, allowed_sheet, allowed, most_rotation, no, serves,
              lanes, turns);
}
