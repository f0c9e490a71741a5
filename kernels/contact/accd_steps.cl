// How much of a motion is free of contact, for each pair (contact/accd.cl).
#include "contact/accd.cl"

// n: pairs
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void accd_steps(
    const uint n, global const Barrier* restrict pairs, global const real* restrict x0, global const real* restrict x1,
    global real* restrict steps, global real* restrict of_64) {
  local real of_item[ITEMS];
  certify_pair(get_global_id(0), n, pairs, x0, x1, steps, of_64, of_item);
}
