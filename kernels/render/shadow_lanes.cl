// Stage 4 on a CPU, sixteen shadow rays at a time: what shadow.cl does, with the same bits.
#include "render/box_lanes.cl"
#include "render/transmittance.cl"

// shadow rays that are taken together once there are sixteen
typedef struct {
  Lanes rays;
  Asked asked;
  uint slot[PACKET];
  uint n;
} Waiting;

// adds their lights and lets none wait
static inline void add_lights(const Trees trees, global const Material* materials, Waiting* w,
                              global const float4* shadow_light, global float4* radiance) {
  for (uint k = w->n; k < PACKET; ++k) set_ray(&w->rays, k, lane_origin(&w->rays, 0), lane_direction(&w->rays, 0));
  uint crosses;
  const uint stopped = lanes_stopped(trees, &w->rays, w->asked, &crosses);
  for (uint k = 0; k < w->n; ++k) {
    if (stopped >> k & 1u) continue;
    const uint slot = w->slot[k];
    const float4 light = shadow_light[slot];
    if (!(crosses >> k & 1u)) {
      radiance[slot] += (float4)(light.xyz * light.w, 0);
      continue;
    }
    const uint mask = w->asked.receivers >> k & 1u ? MASK_RECEIVERS : MASK_SURFACES;
    const Transmittance T =
        transmittance(trees, materials, lane_origin(&w->rays, k), lane_direction(&w->rays, k), BEFORE_LIGHT, mask);
    radiance[slot] += (float4)(light.xyz * T.value * (T.has_crossed ? 1.0f : light.w), 0);
  }
  w->n = w->asked.surfaces = w->asked.receivers = w->asked.through_glass = 0;
}

// arguments as in shadow.cl;  a work-item takes SHADOW_CHUNK places of the queue
kernel __attribute__((reqd_work_group_size(4, 1, 1))) void shadow_lanes(
    const uint n, global const uint* restrict queue, const uint transparent_shadows, global const float8* restrict top,
    global const float8* restrict nodes, global const float4* restrict blocks,
    global const Instance* restrict instances, global const Material* restrict materials,
    global const float4* restrict shadow_origin, global const float4* restrict shadow_direction,
    global const float4* restrict shadow_light, global float4* restrict radiance) {
  const uint first = get_global_id(0) * SHADOW_CHUNK, last = min(n, first + SHADOW_CHUNK);
  const Trees trees = {top, nodes, blocks, instances};
  Waiting w;
  w.n = w.asked.surfaces = w.asked.receivers = w.asked.through_glass = 0;
  for (uint i = first; i < last; ++i) {
    const uint slot = queue[i];
    const float4 from = shadow_origin[slot];
    const uint kind = as_uint(from.w);
    if (kind == SHADOW_NONE) continue;
    const uint bit = 1u << w.n;
    set_ray(&w.rays, w.n, from.xyz, shadow_direction[slot].xyz);
    w.slot[w.n] = slot;
    if (kind == SHADOW_RECEIVER)
      w.asked.receivers |= bit;
    else
      w.asked.surfaces |= bit;
    if (kind == SHADOW_SURFACE_GLASS || (kind == SHADOW_RECEIVER && transparent_shadows)) w.asked.through_glass |= bit;
    if (++w.n == PACKET) add_lights(trees, materials, &w, shadow_light, radiance);
  }
  if (w.n > 0) add_lights(trees, materials, &w, shadow_light, radiance);
}
