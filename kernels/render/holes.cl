// What cut-out surfaces (cutout.cl) ask for, apart from the other stages, so that scenes without any pay nothing: after
// `intersect` the paths that met a hole go on to what is behind it; before `shadow` light is dimmed by what is left of
// cut-out surfaces, which the shadow rays themselves do not see (MASK_CUTOUT_SHIFT).
#ifndef PVG_RENDER_HOLES_CL
#define PVG_RENDER_HOLES_CL
#include "render/cutout.cl"
#include "render/slots.cl"
#include "shared/rng.cl"

// numbers for surfaces that blend, apart from those of shade_path.cl
#define HOLES_KEY 0x51ed270bu

// plain random number: strata gain nothing where the layers differ from path to path
static inline float chance_of_layer(const uint key, const uint sample, const uint layer) {
  return unit_float(hash_combine(hash_combine(key, layer), sample));
}

// the path in a slot;  depth: bounces so far
static inline void pass_holes_of_path(const Trees trees, const Cutouts cutouts, const uint depth, const uint slot,
                                      const Slots slots) {
  const float4 first = slots.hit[slot];
  if (as_uint(first.w) == NO_TRIANGLE || !(cutouts.instances[slots.hit_instance[slot]].flags & INSTANCE_CUTOUT)) return;
  const uint key = hash_combine(slots.stream[slot].x ^ HOLES_KEY, depth), sample = slots.stream[slot].y;
  const float3 from = slots.origin[slot].xyz, d = slots.direction[slot].xyz;
  Hit h = {first.x, first.y, first.z, as_uint(first.w), slots.hit_instance[slot]};
  for (uint layer = 0; layer < MOST_LAYERS && is_open(cutouts, h, chance_of_layer(key, sample, layer)); ++layer)
    next_hit(trees, cutouts, from, d, INFINITY, &h);
  slots.hit[slot] = (float4)(h.t, h.u, h.v, as_float(h.triangle));
  slots.hit_instance[slot] = h.instance;
}

// the share of the light that all hits of one instance let pass
OUT_OF_LINE float share_through_mesh(const Trees trees, const Cutouts cutouts, const BoxRay* box, const LeafRay leaf,
                                     const uint instance, const float t_max) {
  const BoxRay r = *box;
  int stack[BVH_STACK];
  int size = 0, current = (int)trees.instances[instance].root;
  float share = 1.0f;
  for (;;) {
    while (current >= 0)
      if (!descend_any(trees.nodes + (size_t)current * 8, r, t_max, stack, &size, &current)) break;
    if (current < 0) {
      global const float4* block = trees.blocks + (size_t)(~current) * 10;
      float4 t, u, v;
      uint hits = block_hits(block, leaf, t_max, &t, &u, &v);
      float us[4], vs[4];
      vstore4(u, 0, us);
      vstore4(v, 0, vs);
      for (; hits; hits &= hits - 1) {
        const uint k = lowest_bit(hits);
        share *= opening(cutouts, instance, ((global const uint*)(block + 9))[k], us[k], vs[k]);
      }
      if (share == 0) return 0.0f;
    }
    if (size == 0) return share;
    current = stack[--size];
  }
}

// of all cut-out surfaces that the mask names (MASK_..., shifted)
ALWAYS_INLINE float share_through(const Trees trees, const Cutouts cutouts, const float3 origin, const float3 direction,
                                  const float t_max, const uint mask) {
  const BoxRay world = make_box_ray(origin, direction);
  int stack[BVH_STACK];
  int size = 0, current = first_visit(trees.top, 0);
  float share = 1.0f;
  for (;;) {
    while (current >= 0)
      if (!descend_any(trees.top + (size_t)current * 8, world, t_max, stack, &size, &current)) break;
    if (current < 0 && (trees.instances[~current].mask & mask)) {
      const uint i = (uint)(~current);
      const float3 o = affine_point(trees.instances[i].to_object, origin);
      const float3 d = affine_vector(trees.instances[i].to_object, direction);
      const BoxRay box = make_box_ray(o, d);
      share *= share_through_mesh(trees, cutouts, &box, make_leaf_ray(o, d), i, t_max);
      if (share == 0) return 0.0f;
    }
    if (size == 0) return share;
    current = stack[--size];
  }
}

// the shadow ray in a slot: one through which nothing comes is taken away
static inline void dim_shadow_ray(const Trees trees, const Cutouts cutouts, const uint slot, const Slots slots) {
  const float4 from = slots.shadow_origin[slot];
  const uint kind = as_uint(from.w);
  if (kind == SHADOW_NONE) return;
  const uint mask = (kind == SHADOW_RECEIVER ? MASK_RECEIVERS : MASK_SURFACES) << MASK_CUTOUT_SHIFT;
  const float share = share_through(trees, cutouts, from.xyz, slots.shadow_direction[slot].xyz, BEFORE_LIGHT, mask);
  if (share == 0)
    slots.shadow_origin[slot].w = as_float(SHADOW_NONE);
  else
    slots.shadow_light[slot].xyz *= share;
}
#endif
