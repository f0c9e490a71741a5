// Whether pairs that were looked for still serve for a motion from x0 to x1 (host/physics/contact/candidates.hpp).
// serves: one number per list; where it does not serve, `no` is written to it, a number that no check used before.
// All three lists in one launch: a work-group for each body of the first two, then one for each 64 sites of the third.
#ifndef PVG_CONTACT_SERVES_CL
#define PVG_CONTACT_SERVES_CL
#include "shared/svd.cl"
#include "shared/types.h"
#define LANES 64u

// Pairs of bodies: no site may be farther than `allowed` [m] from where it was.
static inline void check_site(const uint site, global const real* restrict reference, global const real* restrict x0,
                              global const real* restrict x1, const real allowed, const uint no, global u32* serves) {
  const real3 from = vload3(site, reference);
  // so that what is not a number moves too
  if (!(length(vload3(site, x0) - from) <= allowed && length(vload3(site, x1) - from) <= allowed)) *serves = no;
}

// the sum over a work-group, in one order
static inline real3 sum_of_lanes(const real3 value, local real* lanes) {
  const uint lane = get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  vstore3(value, lane, lanes);
  for (uint half_of = LANES / 2; half_of > 0; half_of /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane < half_of) vstore3(vload3(lane, lanes) + vload3(lane + half_of, lanes), lane, lanes);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return vload3(0, lanes);
}

// Pairs of one body: apart from the rigid motion that brings it closest to where it was (Kabsch 1976), no site may be
// farther than `allowed` [m], and the motion may not turn it by more than most_rotation [rad].
// sites: those from `begin` to `end` - 1 are the body's, of one work-group
static inline void check_body(const uint begin, const uint end, global const u32* restrict sites,
                              global const real* restrict reference, global const real* restrict x0,
                              global const real* restrict x1, const real allowed, const real most_rotation,
                              const uint no, global u32* serves, local real* lanes, local real* turns) {
  const uint lane = get_local_id(0);
  const real count = end - begin;
  real3 centre = (real3)(0);
  for (uint i = begin + lane; i < end; i += LANES) centre += vload3(sites[i], reference);
  centre = sum_of_lanes(centre, lanes) / count;
  for (uint which = 0; which < 2; ++which) {
    global const real* x = which == 0 ? x0 : x1;
    real3 moved = (real3)(0);
    for (uint i = begin + lane; i < end; i += LANES) moved += vload3(sites[i], x);
    moved = sum_of_lanes(moved, lanes) / count;
    // sum of to from^T; its rotation U V^T is the one that is looked for
    Mat3 covariance = {{(real3)(0), (real3)(0), (real3)(0)}};
    for (uint i = begin + lane; i < end; i += LANES) {
      const real3 from = vload3(sites[i], reference) - centre, to = vload3(sites[i], x) - moved;
      covariance.column[0] += from.x * to;
      covariance.column[1] += from.y * to;
      covariance.column[2] += from.z * to;
    }
    for (int c = 0; c < 3; ++c) covariance.column[c] = sum_of_lanes(covariance.column[c], lanes);
    if (lane == 0) {
      const Svd3 svd = svd3(covariance);
      for (int c = 0; c < 3; ++c) {
        real3 column = (real3)(0);
        for (int k = 0; k < 3; ++k)
          column += svd.u.column[k] * (c == 0 ? svd.v.column[k].x : (c == 1 ? svd.v.column[k].y : svd.v.column[k].z));
        vstore3(column, 3 * which + c, turns);
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const real3 a = vload3(3 * which, turns), b = vload3(3 * which + 1, turns), c = vload3(3 * which + 2, turns);
    for (uint i = begin + lane; i < end; i += LANES) {
      const real3 from = vload3(sites[i], reference) - centre;
      if (!(length(vload3(sites[i], x) - moved - (from.x * a + from.y * b + from.z * c)) <= allowed)) *serves = no;
    }
  }
  if (lane > 0) return;
  // of the rotation between the two: 1 + 2 cos(angle)
  real trace = 0;
  for (int c = 0; c < 3; ++c) trace += dot(vload3(c, turns), vload3(3 + c, turns));
  if (!(trace >= 1 + 2 * cos(most_rotation))) *serves = no;
}

// A work-group's part.  first_*: [n_* + 1] into sites_*;  serves: of solids, sheets and pairs of bodies
// lanes: [3 x LANES], turns: [2 x 9]
static inline void check_lists(const uint n_solids, global const u32* restrict first_solid,
                               global const u32* restrict sites_solid, global const real* restrict reference_solid,
                               const uint n_sheets, global const u32* restrict first_sheet,
                               global const u32* restrict sites_sheet, global const real* restrict reference_sheet,
                               const uint n_surface, global const u32* restrict surface,
                               global const real* restrict reference, global const real* restrict x0,
                               global const real* restrict x1, const real allowed_solid, const real allowed_sheet,
                               const real allowed, const real most_rotation, const uint no, global u32* serves,
                               local real* lanes, local real* turns) {
  const uint group = get_group_id(0);
  if (group < n_solids + n_sheets) {
    const bool is_solid = group < n_solids;
    const uint body = is_solid ? group : group - n_solids;
    global const u32* first = is_solid ? first_solid : first_sheet;
    check_body(first[body], first[body + 1], is_solid ? sites_solid : sites_sheet,
               is_solid ? reference_solid : reference_sheet, x0, x1, is_solid ? allowed_solid : allowed_sheet,
               most_rotation, no, serves + (is_solid ? 0 : 1), lanes, turns);
  } else {
    const uint i = (group - n_solids - n_sheets) * LANES + get_local_id(0);
    if (i < n_surface) check_site(surface[i], reference, x0, x1, allowed, no, serves + 2);
  }
}

#endif
