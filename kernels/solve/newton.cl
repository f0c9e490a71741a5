// What Newton's method decides per world, found on the device so that the host need not look before the line search.
#include "shared/real.h"
#include "shared/types.h"

// How far each world goes along its direction: as far as is certified; nowhere where it is not active or, if `settles`,
// where its correction is within the tolerance.
// n: worlds.  certified: [n] in [0, 1];  is_active: [n];  largest: [n] lengths of the corrections [m];  tolerance: [n,
// m/s];  h [s];  short_of: factor on a step that was cut, which would end where the barrier is steepest
kernel void certified_step(const uint n, global const real* restrict certified, global const u32* restrict is_active,
                           const uint settles, global const real* restrict largest,
                           global const real* restrict tolerance, const real h, const real short_of,
                           global real* restrict step) {
  const uint w = get_global_id(0);
  if (w >= n) return;
  const bool stays = !is_active[w] || (settles && largest[w] / h <= tolerance[w]);
  step[w] = stays ? 0 : (certified[w] < 1 ? short_of * certified[w] : certified[w]);
}
