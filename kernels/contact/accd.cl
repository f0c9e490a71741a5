// Additive continuous collision detection (Li, Kaufman, Jiang 2021, "Codimensional incremental potential contact"):
// the largest certified part of a straight motion that keeps a pair farther apart than its offset.
// From a place with distance d > xi two things are known, and the farther one is gone:
//   - no point of the pair comes closer than by its speed: eta (d - xi) / (max |v_first| + max |v_second|) is safe;
//     (of a plane the points given, which do not move);
//   - the plane across the closest points separates the pair as long as no corner reaches it, which for straight motion
//     is a linear equation per corner pair; for sliding motion this is the whole way in one go.
// Each turn leaves (1 - eta) of the gap; it ends where the gap would fall below (1 - eta) of the first one.
#ifndef PVG_CONTACT_ACCD_CL
#define PVG_CONTACT_ACCD_CL
#include "contact/distance.cl"
#include "energies/contact/barrier.h"
#define ITEMS 64u
#define SLACK 0.9      // eta
#define MAX_TURNS 100  // then the part certified so far is the answer

// how far the motion may go, at most, until the corners' gap along n falls to `least`; 0 where it is there already
static inline real plane_step(const uint kind, const real3* x, const real3* v, const real3 n, const real least) {
  const int n_first = kind == EDGE_EDGE ? 2 : 1;
  real step = INFINITY;
  for (int a = 0; a < n_first; ++a)
    for (int b = n_first; b < 4; ++b) {
      const real room = dot(n, x[a] - x[b]) - least, closing = dot(n, v[b] - v[a]);
      if (room < 0) return 0;
      if (closing > 0) step = fmin(step, room / closing);
    }
  return step;
}

// x: at the start, v: motion over the whole step [4, m]
static inline real certified_step(const uint kind, const real3* x, real3* v, const real offset) {
  // what rounding of the positions may take from a gap
  real size = 0;
  for (int i = 0; i < 4; ++i) size = fmax(size, fmax(length(x[i]), length(v[i])));
  const real noise = 1e-15 * size;
  // what all four do together moves nothing relative to anything
  const real3 mean = 0.25 * (v[0] + v[1] + v[2] + v[3]);
  real speed[4];
  for (int i = 0; i < 4; ++i) {
    v[i] -= mean;
    speed[i] = length(v[i]);
  }
  const real closing = kind == EDGE_EDGE ? fmax(speed[0], speed[1]) + fmax(speed[2], speed[3])
                                         : speed[0] + fmax(fmax(speed[1], speed[2]), speed[3]);
  // most are so far apart that their motion does not lead them together
  if (is_beyond(kind, x, offset + noise + closing / SLACK)) return 1;
  Distance now = pair_distance(kind, x);
  real gap = now.d - offset;
  // written so that NaN stops everything
  if (!(gap > noise) || !(closing >= 0)) return 0;
  const real enough = (1 - SLACK) * gap;
  real t = 0;
  real3 y[4] = {x[0], x[1], x[2], x[3]};
  for (int turn = 0; turn < MAX_TURNS; ++turn) {
    const real by_speed = closing > 0 ? SLACK * gap / closing : INFINITY;
    const real by_plane = plane_step(kind, y, v, now.n, now.d - SLACK * gap);
    const real next = t + fmax(by_speed, by_plane);
    if (next >= 1) return 1;
    for (int i = 0; i < 4; ++i) y[i] = x[i] + next * v[i];
    now = pair_distance(kind, y);
    gap = now.d - offset;
    // the first turn leaves just `enough`, up to rounding
    if (!(gap >= fmax(noise, turn > 0 ? enough : 0.5 * enough))) return t;
    t = next;
  }
  return t;
}

// Pair e of n, by a work-group for each 64.  steps: [n] in [0, 1]; of_64: the least of each 64 of them; x0, x1: sites
// [n_sites x 3, m];  of_item: [ITEMS]
static inline void certify_pair(const uint e, const uint n, global const Barrier* restrict pairs,
                                global const real* restrict x0, global const real* restrict x1,
                                global real* restrict steps, global real* restrict of_64, local real* of_item) {
  const uint item = get_local_id(0);
  real own = 1;
  if (e < n) {
    real3 x[4], v[4];
    for (int i = 0; i < 4; ++i) {
      x[i] = vload3(pairs[e].site[i], x0);
      v[i] = vload3(pairs[e].site[i], x1) - x[i];
    }
    own = certified_step(pairs[e].kind, x, v, pairs[e].offset);
    steps[e] = own;
  }
  of_item[item] = own;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint k = 0; k < (item == 0 ? ITEMS : 0); ++k) own = fmin(own, of_item[k]);
  if (item == 0) of_64[e / ITEMS] = own;
}

#endif
