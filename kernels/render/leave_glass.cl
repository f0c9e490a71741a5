// Between two bounces: paths that have met clear glass and mirrors alone and are inside of a solid of clear glass go on to
// where they leave it. Total internal reflection leads light along a wall of glass over dozens of faces; if each were a
// bounce, paths would end there, and the rims of vessels would be black.
#ifndef PVG_RENDER_LEAVE_GLASS_CL
#define PVG_RENDER_LEAVE_GLASS_CL
#include "render/interact.cl"
#include "render/met_surface.cl"
#include "render/noted.cl"
#include "render/slots.cl"

// the faces that a path may meet here before one bounce
#define MOST_FACES 64u
// random numbers, apart from those of shade_path.cl and generate.cl
#define LEAVE_GLASS_DIMENSION (1u << 17)

// nothing has scattered the path so far
static inline bool is_inside(const Path* path) { return path->media != 0 && !(path->flags & PATH_SCATTERED); }

static inline bool is_clear_solid(global const Material* m, const uint instance_flags) {
  return m->kind == MATERIAL_DIELECTRIC && (m->flags & MATERIAL_HAS_INSIDE) && !(m->flags & MATERIAL_EMITS) &&
         !(instance_flags & INSTANCE_CUTOUT);
}

// The closest hit, first in the solid that the path is inside of: few others are as near.
static inline Hit next_face(const Trees trees, const uint solid, const float3 origin, const float3 direction) {
  Hit h = {INFINITY, 0, 0, NO_TRIANGLE, 0};
  const BoxRay box = make_box_ray(origin, direction);
  const LeafRay leaf = make_leaf_ray(origin, direction);
  if (solid != NO_INSTANCE)
    closest_in_instance(trees, solid, first_visit(trees.nodes, (int)trees.instances[solid].root), origin, direction,
                        &box, &leaf, &h);
  closest_in_others(trees, solid, origin, direction, &box, &leaf, &h);
  return h;
}

// Total internal reflection, without what the other cases need: returned whether it is that.
static inline bool reflects_all(global const Instance* instance, global const Material* m, const Surface s, Path* path) {
  if (m->normal_texture >= 0 || dot(s.face, path->direction) <= 0 || path->media != instance->material + 1) return false;
  const float3 face = -s.face;
  const float3 normal = dot(s.shading, face) > 0 ? s.shading : -s.shading;
  const float cosine = -dot(normal, path->direction);
  if (cosine <= 0 || m->ior * m->ior * (1.0f - cosine * cosine) < 1.0f) return false;
  const float3 direction = path->direction + 2.0f * cosine * normal;
  if (dot(direction, face) < 0) return false;
  path->origin = leave_surface(s.point, face);
  path->direction = unit(direction);
  path->pdf = 0.0f;
  return true;
}

// The face that the path meets. Returned: the solid that has it; NO_INSTANCE: all but clear solids is left to the next
// bounce. distance: in the solid, since its absorption was last reckoned [m]
static inline uint pass_face(const Trees trees, const Shading scene, const uint solid, const uint2 stream,
                             const uint dimension, float* distance, Path* path) {
  const Hit h = next_face(trees, solid, path->origin, path->direction);
  if (h.triangle == NO_TRIANGLE) return NO_INSTANCE;
  global const Instance* instance = scene.instances + h.instance;
  if (instance->visual == 0) return NO_INSTANCE;
  global const Material* shown = scene.materials + instance->material;
  if (!is_clear_solid(shown, instance->flags)) return NO_INSTANCE;
  const Surface s = surface_with_uvs(scene, h.instance, h.triangle, h.u, h.v);
  *distance += h.t + ray_offset(s.point);
  if (reflects_all(instance, shown, s, path)) return h.instance;
  path->throughput *= media_transmission(path->media, scene.materials, *distance);
  *distance = 0.0f;
  const Material m = *shown;
  const float3 color = surface_color(scene, instance, m, s, h.triangle, h.u, h.v);
  const MetSurface met = met_surface(scene, instance, h.triangle, m, color, s, path->direction, path->media);
  if (met.boundary.is_hidden) {
    pass_hidden(met.boundary, s, met.face, path);
    return h.instance;
  }
  const float2 chance = sample_2d(stream.x, stream.y, dimension);
  const float before = path->likelihood;
  pass_glass(met.material, met.boundary, s, met.face, met.normal, chance.x, path);
  path->likelihood *= before;
  roulette(2, chance.y, path);
  return h.instance;
}

// the path in a slot;  depth: bounces so far
static inline void leave_glass_of_path(const Trees trees, const Shading scene, const uint depth,
                                       const uint notes_features, const uint slot, const Slots slots) {
  Path path = load_path(slot, slots.origin, slots.direction, slots.throughput);
  if (!is_inside(&path)) return;
  const uint2 numbers = slots.stream[slot];
  uint solid = NO_INSTANCE;
  float distance = 0.0f;
  for (uint face = 0; face < MOST_FACES && path.is_alive && is_inside(&path); ++face) {
    solid = pass_face(trees, scene, solid, numbers, LEAVE_GLASS_DIMENSION + depth * MOST_FACES + face, &distance, &path);
    if (solid == NO_INSTANCE) break;
  }
  path.throughput *= media_transmission(path.media, scene.materials, distance);
  if (!path.is_alive) path.throughput = 0.0f;  // ends at the next bounce
  slots.origin[slot] = (float4)(path.origin, path.pdf);
  slots.direction[slot] = (float4)(path.direction, as_float(path.media));
  slots.throughput[slot] = (float4)(path.throughput, as_float(path.flags));
  if (notes_features)
    slots.feature_color[slot].w = max(slots.feature_color[slot].w * path.likelihood, LEAST_NOTE);
}
#endif
