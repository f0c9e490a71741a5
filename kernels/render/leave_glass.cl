// Between two bounces: paths that have met clear glass and mirrors alone and are inside of a solid of clear glass go on to
// where they leave it. Total internal reflection leads light along a wall of glass over dozens of faces; if each were a
// bounce, paths would end there, and the rims of vessels would be black.
// Groups are small, as one path may meet a hundred times the faces that another does.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/interact.cl"
#include "render/met_surface.cl"
#include "render/noted.cl"

// the faces that a path may meet here before one bounce
#define MOST_FACES 64u
// random numbers, apart from those of shade.cl and generate.cl
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

// as in shade.cl;  depth: bounces so far
kernel __attribute__((reqd_work_group_size(16, 1, 1))) void leave_glass(
    const uint n, const uint depth, const uint notes_features, global const uint* restrict queue,
    global const uint2* restrict stream, global const float8* restrict top, global const float8* restrict nodes,
    global const float4* restrict blocks, global const Instance* restrict instances,
    global const Material* restrict materials, global const TextureInfo* restrict textures,
    global const uchar4* restrict texels, constant float* restrict decode, global const uint* restrict triangles,
    global const Vertex* restrict vertices, global const float* restrict colors,
    global const float* restrict second_uvs, global float4* restrict origin, global float4* restrict direction,
    global float4* restrict throughput, global float4* restrict feature_color) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint slot = queue[i];
  Path path = load_path(slot, origin, direction, throughput);
  if (!is_inside(&path)) return;
  const Trees trees = {top, nodes, blocks, instances};
  const Shading scene = {instances, materials, textures,   texels, decode, triangles, vertices,
                         colors,    second_uvs, 0,      0,      0,         0};
  const uint2 numbers = stream[slot];
  uint solid = NO_INSTANCE;
  float distance = 0.0f;
  for (uint face = 0; face < MOST_FACES && path.is_alive && is_inside(&path); ++face) {
    solid = pass_face(trees, scene, solid, numbers, LEAVE_GLASS_DIMENSION + depth * MOST_FACES + face, &distance, &path);
    if (solid == NO_INSTANCE) break;
  }
  path.throughput *= media_transmission(path.media, scene.materials, distance);
  if (!path.is_alive) path.throughput = 0.0f;  // ends at the next bounce
  origin[slot] = (float4)(path.origin, path.pdf);
  direction[slot] = (float4)(path.direction, as_float(path.media));
  throughput[slot] = (float4)(path.throughput, as_float(path.flags));
  if (notes_features) feature_color[slot].w = max(feature_color[slot].w * path.likelihood, LEAST_NOTE);
}
