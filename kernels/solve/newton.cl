// What Newton's method decides per world, found on the device so that the host need not look before the line search.
#include "solve/world_least.cl"

// How far each world goes along its direction: as far as all its pairs are certified; nowhere where it is not active or,
// if `settles`, where its correction is within the tolerance. One work-group per world.
// n_items: 64 n_worlds.  first: [n_worlds + 1] of the worlds' pairs;  certified: [n_pairs] in [0, 1];  is_active:
// [n_worlds];  largest: [n_worlds] lengths of the corrections [m];  tolerance: [n_worlds, m/s];  h [s];  short_of: factor
// on a step that was cut, which would end where the barrier is steepest;  step: [n_worlds]
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void certified_step(
    const uint n_items, global const u32* restrict first, global const real* restrict certified,
    global const u32* restrict is_active, const uint settles, global const real* restrict largest,
    global const real* restrict tolerance, const real h, const real short_of, global real* restrict step) {
  local real of_item[ITEMS];
  const real least = least_of_world(first, certified, 1, of_item);
  if (get_local_id(0) > 0) return;
  const uint w = get_group_id(0);
  const bool stays = !is_active[w] || (settles && largest[w] / h <= tolerance[w]);
  step[w] = stays ? 0 : (least < 1 ? short_of * least : least);
}
