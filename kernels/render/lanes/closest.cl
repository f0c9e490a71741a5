// Closest hits of the rays of a queue and of rays that start side by side, with the bits that each would find alone; of
// two triangles at the same t either may be found.
#ifndef PVG_RENDER_LANES_CLOSEST_CL
#define PVG_RENDER_LANES_CLOSEST_CL
#include "render/lanes/meshes.cl"
#include "render/lanes/rows.cl"

// in the whole scene, apart from the others
OUT_OF_LINE void find_closest_alone(const Trees trees, const float3 origin, const float3 direction, Hit* hit) {
  Hit found = {INFINITY, 0, 0, NO_TRIANGLE, 0};
  closest_hit(trees, origin, direction, &found);
  *hit = found;
}

// The rays number first .. first + 15 of n in a queue go through the tree over instances. rays: of this packet, whose
// hits are written;  returned: bits of those that may meet more in meshes
ALWAYS_INLINE uint begin_packet(const Trees trees, const uint first, const uint n, global const uint* queue,
                                global const float4* origin, global const float4* direction, MeshPacket* p,
                                MeshRay* rays) {
  uint slot[PACKET];
  for (uint k = 0; k < PACKET; ++k) slot[k] = queue[min(first + k, n - 1)];  // the last lanes are filled up
  Lanes* lanes = &p->lanes;
  store_packet(vectors_of(load_rows(origin, slot, 1, 0)), lanes->origin);
  store_packet(vectors_of(load_rows(direction, slot, 1, 0)), lanes->direction);
  p->is_moved = 0;
  find_visits(trees, lanes, &p->box, &p->leaf, &p->visits);
  const bool is_full = p->visits.n_starts > MOST_STARTS;
  uint goes_on = 0;
  for (uint k = 0; k < PACKET && first + k < n; ++k) {
    const Hit found = {lanes->t[k], lanes->u[k], lanes->v[k], lanes->triangle[k], lanes->instance[k]};
    rays[k].hit = found;
    if (is_full || p->visits.n[k] > MOST_VISITS)
      find_closest_alone(trees, lane_origin(lanes, k), lane_direction(lanes, k), &rays[k].hit);
    else
      goes_on |= (p->visits.n[k] > 0 ? 1u : 0u) << k;
  }
  return goes_on;
}

// n rays of a queue
OUT_OF_LINE void find_closest_of_queue(const Trees trees, const uint n, global const uint* queue,
                                       global const float4* origin, global const float4* direction,
                                       global float4* hit, global uint* hit_instance) {
  MeshPacket packets[PACKETS_IN_TURN];
  MeshRay rays[RAYS_IN_TURN];
  for (uint first = 0; first < n; first += RAYS_IN_TURN) {
    const uint n_here = min(n - first, (uint)RAYS_IN_TURN);
    uint goes_on[PACKETS_IN_TURN];
    for (uint p = 0; p < PACKETS_IN_TURN; ++p) {
      const uint at = p * PACKET;
      goes_on[p] =
          at < n_here ? begin_packet(trees, first + at, n, queue, origin, direction, packets + p, rays + at) : 0;
    }
    find_closest_in_meshes(trees, goes_on, packets, rays);
    for (uint k = 0; k < n_here; ++k) {
      const uint slot = queue[first + k];
      hit[slot] = (float4)(rays[k].hit.t, rays[k].hit.u, rays[k].hit.v, as_float(rays[k].hit.triangle));
      hit_instance[slot] = rays[k].hit.instance;
    }
  }
}

// n rays that start in neighbouring pixels, in the first slots
OUT_OF_LINE void find_closest_of_neighbours(const Trees trees, const uint n,
                                            global const float4* origin, global const float4* direction,
                                            global float4* hit, global uint* hit_instance) {
  Lanes lanes;
  for (uint i = 0; i < n; i += PACKET) {
    for (uint k = 0; k < PACKET; ++k) {
      const uint slot = min(i + k, n - 1);
      set_ray(&lanes, k, origin[slot].xyz, direction[slot].xyz);
    }
    find_closest_of_lanes(trees, &lanes);
    for (uint k = 0; k < PACKET && i + k < n; ++k) {
      hit[i + k] = (float4)(lanes.t[k], lanes.u[k], lanes.v[k], as_float(lanes.triangle[k]));
      hit_instance[i + k] = lanes.instance[k];
    }
  }
}
#endif
