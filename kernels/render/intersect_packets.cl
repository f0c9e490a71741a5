// Stage 2 of a CPU's camera rays: closest hit of each slot, sixteen neighbours together where they go the same way.
#include "render/packet.cl"

ALWAYS_INLINE Packet load_packet(global const float4* vectors, const uint first, const uint n) {
  float x[PACKET], y[PACKET], z[PACKET];
  for (uint k = 0; k < PACKET; ++k) {
    const float4 v = vectors[min(first + k, n - 1)];  // the last packet is filled up
    x[k] = v.x;
    y[k] = v.y;
    z[k] = v.z;
  }
  const Packet p = {vload16(0, x), vload16(0, y), vload16(0, z)};
  return p;
}

// arguments as in intersect.cl, of the slots 0 .. n - 1;  a work-item takes PACKET of them
kernel __attribute__((reqd_work_group_size(4, 1, 1))) void intersect_packets(
    const uint n, global const float8* restrict top, global const float8* restrict nodes,
    global const float4* restrict blocks, global const Instance* restrict instances,
    global const float4* restrict origin, global const float4* restrict direction, global float4* restrict hit,
    global uint* restrict hit_instance) {
  const uint first = get_global_id(0) * PACKET;
  if (first >= n) return;
  const Trees trees = {top, nodes, blocks, instances};
  const Packet o = load_packet(origin, first, n), d = load_packet(direction, first, n);
  PacketHit hits = {INFINITY, 0.0f, 0.0f, NO_TRIANGLE, 0};
  const uint n_rays = min((uint)PACKET, n - first);
  if (closest_of_packet(trees, &o, &d, &hits)) {
    Lanes lanes;
    store_hits(hits, &lanes);
    for (uint k = 0; k < n_rays; ++k) {
      hit[first + k] = (float4)(lanes.t[k], lanes.u[k], lanes.v[k], as_float(lanes.triangle[k]));
      hit_instance[first + k] = lanes.instance[k];
    }
    return;
  }
  for (uint slot = first; slot < first + n_rays; ++slot) {
    Hit h = {INFINITY, 0, 0, NO_TRIANGLE, 0};
    closest_hit(trees, origin[slot].xyz, direction[slot].xyz, &h);
    hit[slot] = (float4)(h.t, h.u, h.v, as_float(h.triangle));
    hit_instance[slot] = h.instance;
  }
}
