// Where bodies come near any that they may touch, while the sites move straight from x0 to x1: by a box of each body, which
// holds those of its primitives in the trees of contact/broad_phase.cl. Elsewhere nothing need be looked for.
#include "contact/box.cl"
#include "contact/mesh.h"
#include "shared/types.h"
#define ITEMS 64u

// the whole box of a work-group's items;  bounds: [2 x ITEMS x 3]
static inline Box box_of_group(const Box own, local float* bounds) {
  const uint item = get_local_id(0);
  vstore3(own.low, 2 * item, bounds);
  vstore3(own.high, 2 * item + 1, bounds);
  for (uint half_of = ITEMS / 2; half_of > 0; half_of /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < half_of) {
      const uint other = item + half_of;
      vstore3(fmin(vload3(2 * item, bounds), vload3(2 * other, bounds)), 2 * item, bounds);
      vstore3(fmax(vload3(2 * item + 1, bounds), vload3(2 * other + 1, bounds)), 2 * item + 1, bounds);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const Box box = {vload3(0, bounds), vload3(1, bounds)};
  return box;
}

// n: 64 x bodies;  first_site: [n_bodies + 1] into sites;  boxes: [n_bodies x 6] low, high [m]
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void body_boxes(
    const uint n, global const u32* restrict first_site, global const u32* restrict sites,
    global const CollisionBodyRow* restrict bodies, global const CollisionWorld* restrict worlds, const real margin,
    global const real* restrict x0, global const real* restrict x1, global float* restrict boxes) {
  local float bounds[6 * ITEMS];
  const uint body = get_group_id(0);
  Box box = empty_box();
  for (uint i = first_site[body] + get_local_id(0); i < first_site[body + 1]; i += ITEMS)
    box = box_of_site(sites[i], x0, x1, box);
  box = box_of_group(box, bounds);
  // grown twice, so that rounding leaves no primitive's own box outside
  box = grow(grow(box, 0.5 * (worlds[bodies[body].world].activation_distance + margin) + bodies[body].offset), 0);
  if (bodies[body].is_half_space) box.low = (float3)(-INFINITY), box.high = (float3)(INFINITY);
  if (get_local_id(0) > 0) return;
  vstore3(box.low, 2 * body, boxes);
  vstore3(box.high, 2 * body + 1, boxes);
}

// The boxes of a pair of primitives meet within what the boxes of both bodies share. For each body, the box around what
// it shares with any body that it may touch.
// n: bodies;  near: [n x 8] low, -high [m], two that are not read; an empty box where nothing is shared
kernel void near_bodies(const uint n, global const CollisionBodyRow* restrict bodies,
                        global const CollisionWorld* restrict worlds, global const real* restrict pair_friction,
                        global const float* restrict boxes, global float* restrict near) {
  const uint body = get_global_id(0);
  if (body >= n) return;
  const CollisionBodyRow own = bodies[body];
  const CollisionWorld world = worlds[own.world];
  const uint first = body - own.index;  // body of its world
  const float3 low = vload3(2 * body, boxes), high = vload3(2 * body + 1, boxes);
  Box found = empty_box();
  for (uint k = 0; k < world.n_bodies; ++k) {
    if (pair_friction[world.first_pair + own.index * world.n_bodies + k] < 0) continue;
    const float3 from = vload3(2 * (first + k), boxes), to = vload3(2 * (first + k) + 1, boxes);
    // written so that what is not a number is near
    const int3 apart = low > to | from > high;
    if (any(apart)) continue;
    // a body at no number counts as everywhere, since fmin and fmax would pass over it
    const Box shared = any(isnan(low) | isnan(high) | isnan(from) | isnan(to)) ? (Box){(float3)(-INFINITY), (float3)(INFINITY)}
                                                          : (Box){fmax(low, from), fmin(high, to)};
    found.low = fmin(found.low, shared.low);
    found.high = fmax(found.high, shared.high);
  }
  vstore8((float8)(found.low, -found.high, 0, 0), body, near);
}
