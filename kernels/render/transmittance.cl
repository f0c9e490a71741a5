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

inline float3 block_corner(global const float4* block, const uint corner, const uint k) {
  global const float* p = (global const float*)(block + 3 * corner) + k;
  return (float3)(p[0], p[4], p[8]);
}

// the glass of one block; direction_length turns t into metres. r in the mesh's frame, but t is the same in every frame
inline void cross_glass(global const float4* block, const BoxRay r, const float t_max, const Material material,
                        const float direction_length, Transmittance* T) {
  float4 t, u, v;
  int4 is_front;
  uint hits = block_hits(block, r, t_max, true, &t, &u, &v, &is_front);
  float ts[4];
  int front[4];
  vstore4(t, 0, ts);
  vstore4(is_front, 0, front);
  for (; hits; hits &= hits - 1) {
    const uint k = lowest_bit(hits);
    const float3 p = block_corner(block, 0, k);
    const float3 normal = normalize(cross(block_corner(block, 1, k) - p, block_corner(block, 2, k) - p));
    // rigid instances: angles in the mesh's frame are those of the world
    const float cosine = fabs(dot(normal, normalize(r.direction)));
    const float R = fresnel_dielectric(cosine, material.ior);
    T->value *= sqrt((1.0f - R) / (1.0f + R));
    const float way = (front[k] ? -ts[k] : ts[k]) * direction_length;
    T->optical += vload3(0, material.absorption) * way;
    T->has_crossed = 1;
  }
}

// false: an opaque triangle was met
inline bool transmit_mesh(const Trees trees, const BoxRay r, const int root, const float t_max, const int is_clear,
                          const Material material, const float direction_length, Transmittance* T) {
  int stack[BVH_STACK];
  int size = 0, current = root;
  for (;;) {
    if (current >= 0) {
      global const float8* node = trees.nodes + (size_t)current * 8;
      global const int* child = (global const int*)(node + 6);
      float8 entry;
      for (uint hits = node_hits(node, r, t_max, &entry); hits; hits &= hits - 1)
        stack[size++] = child[lowest_bit(hits)];
    } else {
      global const float4* block = trees.blocks + (size_t)(~current) * 10;
      if (is_clear) {
        cross_glass(block, r, t_max, material, direction_length, T);
      } else {
        float4 t, u, v;
        int4 is_front;
        if (block_hits(block, r, t_max, false, &t, &u, &v, &is_front)) return false;
      }
    }
    if (size == 0) return true;
    current = stack[--size];
  }
}

// from the origin to t_max = just short of the light. mask: MASK_...; passes_glass: clear glass attenuates, else it
// stops
inline Transmittance transmittance(const Trees trees, global const Material* materials, const float3 origin,
                                   const float3 direction, const float t_max, const uint mask, const int passes_glass) {
  Transmittance T;
  T.value = 1.0f;
  T.optical = 0.0f;
  T.has_crossed = 0;
  const BoxRay world = make_ray(origin, direction);
  const float direction_length = length(direction);
  int stack[BVH_STACK];
  int size = 0, current = 0;
  for (;;) {
    if (current >= 0) {
      global const float8* node = trees.top + (size_t)current * 8;
      global const int* child = (global const int*)(node + 6);
      float8 entry;
      for (uint hits = node_hits(node, world, t_max, &entry); hits; hits &= hits - 1)
        stack[size++] = child[lowest_bit(hits)];
    } else {
      global const Instance* instance = trees.instances + (~current);
      if (instance->mask & mask) {
        const BoxRay r =
            make_ray(affine_point(instance->to_object, origin), affine_vector(instance->to_object, direction));
        const int is_clear = passes_glass && (instance->flags & INSTANCE_CLEAR);
        if (!transmit_mesh(trees, r, (int)instance->root, t_max, is_clear, materials[instance->material],
                           direction_length, &T)) {
          T.value = 0.0f;
          return T;
        }
      }
    }
    if (size == 0) break;
    current = stack[--size];
  }
  if (T.has_crossed) T.value *= exp(-max(T.optical, (float3)(0.0f)));
  return T;
}
#endif
