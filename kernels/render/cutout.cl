// Where surfaces are cut out: glTF's alphaMode. The alpha of a point is its material's opacity times the alpha of the
// texture there. A mask has a hole where alpha is below its cutoff; a surface that blends stops the share alpha of the
// light and lets the rest go straight on. Rays meet such surfaces as if they were whole; what follows asks here.
#ifndef PVG_RENDER_CUTOUT_CL
#define PVG_RENDER_CUTOUT_CL
#include "materials/material.h"
#include "materials/texture.cl"
#include "render/surface.cl"

// after so many layers on its way a ray stops
#define MOST_LAYERS 256

// what the question takes of the scene
typedef struct {
  global const Instance* instances;
  global const Material* materials;
  global const TextureInfo* textures;
  global const uchar4* texels;
  global const uint* triangles;
  global const Vertex* vertices;
  global const float* second_uvs;
} Cutouts;

// where a texture is looked up; bit: SECOND_UVS_...
static inline float2 texture_uv(const Cutouts c, global const Instance* instance, const uint material_flags,
                                const uint bit, const uint triangle, const float u, const float v) {
  if ((material_flags & bit) && (instance->flags & INSTANCE_SECOND_UVS))
    return second_uv_at(instance, c.triangles, c.second_uvs, triangle, u, v);
  const uint3 corner = vload3(triangle, c.triangles);
  return (1.0f - u - v) * vload2(0, c.vertices[corner.x].uv) + u * vload2(0, c.vertices[corner.y].uv) +
         v * vload2(0, c.vertices[corner.z].uv);
}

// the share of the light that goes straight on: 0 or 1 of a mask
static inline float opening(const Cutouts c, const uint instance, const uint triangle, const float u, const float v) {
  global const Material* m = c.materials + c.instances[instance].material;
  float alpha = m->opacity;
  if (m->texture >= 0)
    alpha *= texture_alpha(c.textures[m->texture], c.texels,
                           texture_uv(c, c.instances + instance, m->flags, SECOND_UVS_COLOR, triangle, u, v));
  if (m->flags & MATERIAL_MASK) return alpha < m->alpha_cutoff ? 1.0f : 0.0f;
  return 1.0f - alpha;
}

// whether a ray goes on past its hit; chance: uniform, for what blends
static inline bool is_open(const Cutouts c, const Hit hit, const float chance) {
  return hit.triangle != NO_TRIANGLE && (c.instances[hit.instance].flags & INSTANCE_CUTOUT) &&
         chance < opening(c, hit.instance, hit.triangle, hit.u, hit.v);
}

// From a hit that is open to the next one on the same ray: t still counts from the origin, up to t_max.
ALWAYS_INLINE void next_hit(const Trees trees, const Cutouts c, const float3 origin, const float3 direction,
                            const float t_max, Hit* hit) {
  const Surface s =
      surface_at(c.instances + hit->instance, c.triangles, c.vertices, hit->triangle, hit->u, hit->v);
  const float t = hit->t;
  const Hit next = {t_max - t, 0, 0, NO_TRIANGLE, 0};
  *hit = next;
  closest_hit(trees, leave_surface(s.point, dot(s.face, direction) > 0 ? s.face : -s.face), direction, hit);
  hit->t += t;
}

// the closest hit that is there; what blends is there where it stops more than half
ALWAYS_INLINE void closest_solid_hit(const Trees trees, const Cutouts c, const float3 origin, const float3 direction,
                                     Hit* hit) {
  const float t_max = hit->t;
  closest_hit(trees, origin, direction, hit);
  for (int layer = 0; layer < MOST_LAYERS && is_open(c, *hit, 0.5f); ++layer)
    next_hit(trees, c, origin, direction, t_max, hit);
}
#endif
