// How much of the light of a straight shadow ray arrives: any hit of an opaque instance stops it. Clear glass may let
// it pass straight through as if the walls were thin and parallel: each interface takes its Fresnel share R for a thin
// slab with all internal reflections, (1 - R) / (1 + R) for the two interfaces, and the way inside is absorbed,
//   exp(-sigma l),  l = sum of t over exits - sum of t over entries,
// whatever the order in which the hits are found.
#ifndef PVG_RENDER_TRANSMITTANCE_CL
#define PVG_RENDER_TRANSMITTANCE_CL
#include "materials/dielectric.cl"
#include "materials/material.h"
#include "render/traverse.cl"

typedef struct {
  float3 value;     // of the interfaces [0..1]
  float3 optical;   // sum of sigma l
  int has_crossed;  // glass was met
} Transmittance;

static inline float3 block_corner(global const float4* block, const uint corner, const uint k) {
  global const float* p = (global const float*)(block + 3 * corner) + k;
  return (float3)(p[0], p[4], p[8]);
}

// the glass of one block; direction_length turns t into metres. r in the mesh's frame, but t is the same in every frame
static inline void cross_block(global const float4* block, const LeafRay r, const float3 direction, const float t_max,
                               global const Material* material, const float direction_length, Transmittance* T) {
  float4 t;
  int4 is_front;
  uint hits = block_crossings(block, r, t_max, &t, &is_front);
  float ts[4];
  int front[4];
  vstore4(t, 0, ts);
  vstore4(is_front, 0, front);
  for (; hits; hits &= hits - 1) {
    const uint k = lowest_bit(hits);
    const float3 p = block_corner(block, 0, k);
    const float3 normal = normalize(cross(block_corner(block, 1, k) - p, block_corner(block, 2, k) - p));
    // rigid instances: angles in the mesh's frame are those of the world
    const float cosine = fabs(dot(normal, normalize(direction)));
    const float R = fresnel_dielectric(cosine, material->ior), passes = (1.0f - R) / (1.0f + R);
    T->has_crossed = 1;
    // a thin sheet is both interfaces at once
    T->value *= vload3(0, material->color) * (material->flags & MATERIAL_THIN ? passes : sqrt(passes));
    if (material->flags & MATERIAL_THIN) continue;
    const float way = (front[k] ? -ts[k] : ts[k]) * direction_length;
    T->optical += vload3(0, material->absorption) * way;
  }
}

// all crossings of the glass of one mesh
OUT_OF_LINE void cross_mesh(const Trees trees, const BoxRay* box, const LeafRay leaf, const float3 direction,
                            const int root, const float t_max, global const Material* material,
                            const float direction_length, Transmittance* T) {
  const BoxRay r = *box;
  int stack[BVH_STACK];
  int size = 0, current = root;
  for (;;) {
    while (current >= 0)
      if (!descend_any(trees.nodes + (size_t)current * 8, r, t_max, stack, &size, &current)) break;
    if (current < 0)
      cross_block(trees.blocks + (size_t)(~current) * 10, leaf, direction, t_max, material, direction_length, T);
    if (size == 0) return;
    current = stack[--size];
  }
}

// one instance on the way of the light, true: it lets it pass. origin, direction: of the world
ALWAYS_INLINE bool pass_instance(const Trees trees, global const Material* materials, global const Instance* instance,
                                 const BoxRay* world, const float3 origin, const float3 direction, const float t_max,
                                 Transmittance* T) {
  const bool is_moved = !(instance->flags & INSTANCE_UNMOVED);
  const float3 o = is_moved ? affine_point(instance->to_object, origin) : origin;
  const float3 d = is_moved ? affine_vector(instance->to_object, direction) : direction;
  const BoxRay box = is_moved ? make_box_ray(o, d) : *world;
  const LeafRay leaf = make_leaf_ray(o, d);
  if (!(instance->flags & INSTANCE_CLEAR)) return !any_in_mesh(trees, &box, &leaf, (int)instance->root, t_max);
  cross_mesh(trees, &box, leaf, d, (int)instance->root, t_max, materials + instance->material, length(direction), T);
  return true;
}

// from the origin to t_max = just short of the light, clear glass attenuates; mask: MASK_...
OUT_OF_LINE Transmittance transmittance(const Trees trees, global const Material* materials, const float3 origin,
                                        const float3 direction, const float t_max, const uint mask) {
  Transmittance T;
  T.value = 1.0f;
  T.optical = 0.0f;
  T.has_crossed = 0;
  const BoxRay world = make_box_ray(origin, direction);
  int stack[BVH_STACK];
  int size = 0, current = first_visit(trees.top, 0);
  for (;;) {
    while (current >= 0)
      if (!descend_any(trees.top + (size_t)current * 8, world, t_max, stack, &size, &current)) break;
    if (current < 0 && (trees.instances[~current].mask & mask) &&
        !pass_instance(trees, materials, trees.instances + (~current), &world, origin, direction, t_max, &T)) {
      T.value = 0.0f;
      return T;
    }
    if (size == 0) break;
    current = stack[--size];
  }
  if (T.has_crossed) T.value *= exp(-max(T.optical, (float3)(0.0f)));
  return T;
}
#endif
