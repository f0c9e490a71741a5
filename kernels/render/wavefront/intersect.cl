// Stage 2: closest hit of every live path.
#include "render/traverse.cl"

// top, nodes, blocks: bvh.h;  hit: [n_slots] t, u, v, triangle;  hit_instance: [n_slots]
kernel void intersect(const uint n, global const uint* restrict queue, global const float8* restrict top,
                      global const float8* restrict nodes, global const float4* restrict blocks,
                      global const Instance* restrict instances, global const float4* restrict origin,
                      global const float4* restrict direction, global float4* restrict hit,
                      global uint* restrict hit_instance) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint slot = queue[i];
  const Trees trees = {top, nodes, blocks, instances};
  Hit h = {INFINITY, 0, 0, NO_TRIANGLE, 0};
  closest_hit(trees, origin[slot].xyz, direction[slot].xyz, &h);
  hit[slot] = (float4)(h.t, h.u, h.v, as_float(h.triangle));
  hit_instance[slot] = h.instance;
}
