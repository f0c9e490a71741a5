// Stage 2 of rays whose neighbours go much the same way, on a CPU: closest hit of each slot, sixteen at a time.
#include "render/packet.cl"

// arguments as in intersect.cl, of the slots 0 .. n - 1;  a work-item takes PACKET of them
kernel __attribute__((reqd_work_group_size(4, 1, 1))) void intersect_packets(
    const uint n, global const float8* restrict top, global const float8* restrict nodes,
    global const float4* restrict blocks, global const Instance* restrict instances,
    global const float4* restrict origin, global const float4* restrict direction, global float4* restrict hit,
    global uint* restrict hit_instance) {
  const uint first = get_global_id(0) * PACKET;
  if (first >= n) return;
  const Trees trees = {top, nodes, blocks, instances};
  Lanes lanes;
  for (uint k = 0; k < PACKET; ++k) {
    const uint slot = min(first + k, n - 1);  // the last packet is filled up
    set_ray(&lanes, k, origin[slot].xyz, direction[slot].xyz);
  }
  find_closest_of_lanes(trees, &lanes);
  for (uint k = 0; k < PACKET && first + k < n; ++k) {
    hit[first + k] = (float4)(lanes.t[k], lanes.u[k], lanes.v[k], as_float(lanes.triangle[k]));
    hit_instance[first + k] = lanes.instance[k];
  }
}
