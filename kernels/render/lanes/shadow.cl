// Stage 4 on a CPU, sixteen shadow rays at a time: what render/wavefront/shadow.cl does, with the same bits.
#ifndef PVG_RENDER_LANES_SHADOW_CL
#define PVG_RENDER_LANES_SHADOW_CL
#include "render/lanes/box.cl"
#include "render/slots.cl"
#include "render/transmittance.cl"

// shadow rays that are taken together once there are sixteen
typedef struct {
  Lanes rays;
  Asked asked;
  uint slot[PACKET];
  uint n;
} Waiting;

// adds their lights and lets none wait
static inline void add_lights(const Trees trees, global const Material* materials, Waiting* w, const Slots* slots) {
  for (uint k = w->n; k < PACKET; ++k) set_ray(&w->rays, k, lane_origin(&w->rays, 0), lane_direction(&w->rays, 0));
  uint crosses;
  const uint stopped = lanes_stopped(trees, &w->rays, w->asked, &crosses);
  for (uint k = 0; k < w->n; ++k) {
    if (stopped >> k & 1u) continue;
    const uint slot = w->slot[k];
    const float4 light = slots->shadow_light[slot];
    if (!(crosses >> k & 1u)) {
      slots->radiance[slot] += (float4)(light.xyz * light.w, 0);
      continue;
    }
    const uint mask = w->asked.receivers >> k & 1u ? MASK_RECEIVERS : MASK_SURFACES;
    const Transmittance T =
        transmittance(trees, materials, lane_origin(&w->rays, k), lane_direction(&w->rays, k), BEFORE_LIGHT, mask);
    slots->radiance[slot] += (float4)(light.xyz * T.value * (T.has_crossed ? 1.0f : light.w), 0);
  }
  w->n = w->asked.surfaces = w->asked.receivers = w->asked.through_glass = 0;
}

// of the paths at n places of the queue
OUT_OF_LINE void add_light_of_places(const Trees trees, global const Material* materials,
                                     const uint transparent_shadows, const ushort* places, const uint n,
                                     const Slots* slots) {
  Waiting w;
  w.n = w.asked.surfaces = w.asked.receivers = w.asked.through_glass = 0;
  for (uint i = 0; i < n; ++i) {
    const uint slot = slots->queue[places[i]];
    const float4 from = slots->shadow_origin[slot];
    const uint kind = as_uint(from.w);
    if (kind == SHADOW_NONE) continue;
    const uint bit = 1u << w.n;
    set_ray(&w.rays, w.n, from.xyz, slots->shadow_direction[slot].xyz);
    w.slot[w.n] = slot;
    if (kind == SHADOW_RECEIVER)
      w.asked.receivers |= bit;
    else
      w.asked.surfaces |= bit;
    if (kind == SHADOW_SURFACE_GLASS || (kind == SHADOW_RECEIVER && transparent_shadows)) w.asked.through_glass |= bit;
    if (++w.n == PACKET) add_lights(trees, materials, &w, slots);
  }
  if (w.n > 0) add_lights(trees, materials, &w, slots);
}

// Shares of the light samples of sixteen paths that arrive, by colour, 0 of the lanes that are not asked. weight: of
// those that nothing attenuates, as in shadow_light
OUT_OF_LINE void find_arriving(const Trees* trees, global const Material* materials, const Lanes* rays,
                               const Asked* asked, const float16 weight, Packet* share) {
  uint crosses;
  const uint arrive = (asked->surfaces | asked->receivers) & ~lanes_stopped(*trees, rays, *asked, &crosses);
  const float16 even = lanes_of(arrive) ? weight : (float16)(0.0f);
  share->x = share->y = share->z = even;
  crosses &= arrive;
  if (!crosses) return;
  float shares[3][PACKET], weights[PACKET];
  store_packet(*share, shares);
  vstore16(weight, 0, weights);
  for (; crosses; crosses &= crosses - 1) {
    const uint k = lowest_bit(crosses), mask = asked->receivers >> k & 1u ? MASK_RECEIVERS : MASK_SURFACES;
    const Transmittance T =
        transmittance(*trees, materials, lane_origin(rays, k), lane_direction(rays, k), BEFORE_LIGHT, mask);
    const float3 found = T.value * (T.has_crossed ? 1.0f : weights[k]);
    shares[0][k] = found.x;
    shares[1][k] = found.y;
    shares[2][k] = found.z;
  }
  *share = load_packet(shares);
}
#endif
