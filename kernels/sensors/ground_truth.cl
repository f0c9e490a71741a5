// What is exactly at the middle of each pixel: depth along the optical axis, distance, instance and normal, with no
// mixing at edges. Glass is a surface like any other, or is looked through, straight on; holes of masks are not there.
#include "materials/list.cl"
#include "render/cutout.cl"

// a surface that is looked through where glass is
static inline bool is_glass(global const Instance* instance, global const Material* materials) {
  if (instance->visual == 0) return false;
  global const Material* m = materials + instance->material;
  return (material_traits(m->kind) & MATERIAL_CLEAR) || m->transmission > 0.5f;
}

// the first surface along the ray; the return value is its distance [m]. direction: unit
static inline float seen_surface(const Trees trees, const Cutouts c, const uint sees_through_glass, const float3 from,
                                 const float3 direction, Hit* hit, Surface* surface) {
  float3 origin = from;
  for (int layer = 0; layer < MOST_LAYERS; ++layer) {
    const Hit nothing = {INFINITY, 0, 0, NO_TRIANGLE, 0};
    *hit = nothing;
    closest_hit(trees, origin, direction, hit);
    if (hit->triangle == NO_TRIANGLE) break;
    *surface = surface_at(trees.instances + hit->instance, c.triangles, c.vertices, hit->triangle, hit->u, hit->v);
    const bool passes_glass = sees_through_glass && is_glass(trees.instances + hit->instance, c.materials);
    if (!passes_glass && !is_open(c, *hit, 0.5f))
      return dot(surface->point - from, direction);
    origin = leave_surface(surface->point, dot(surface->face, direction) > 0 ? surface->face : -surface->face);
  }
  hit->triangle = NO_TRIANGLE;
  return INFINITY;
}

// origin, direction: [n_pixels] of rays through the middles;  throughput: 0 where the camera sees nothing;  depth,
// distance: [height x width, m], infinite: nothing;  instance: [height x width] 1 + index of the Visual, 0: none or a
// light; normal: [height x width x 3] unit, world, toward the camera, or 0;  seen: [height x width] place of the hit: u,
// v, triangle, instance;  place: [height x width, m] the point, world, w: distance
kernel void ground_truth(const uint n_pixels, const Launch launch, global const uint* restrict pixels,
                         const uint sees_through_glass,
                         global const float8* restrict top, global const float8* restrict nodes,
                         global const float4* restrict blocks, global const Instance* restrict instances,
                         global const Material* restrict materials, global const uint* restrict triangles,
                         global const Vertex* restrict vertices, global const TextureInfo* restrict textures,
                         global const uchar4* restrict texels, global const float* restrict second_uvs,
                         global const float4* restrict origin, global const float4* restrict direction,
                         global const float4* restrict throughput, global float* restrict depth,
                         global float* restrict distance, global uint* restrict instance,
                         global float* restrict normal, global float4* restrict seen, global float4* restrict place) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const PinholeCamera c = launch.camera;
  const uint at = pixels[launch.first_pixel + i];
  depth[at] = INFINITY;
  distance[at] = INFINITY;
  instance[at] = 0;
  vstore3((float3)(0.0f), at, normal);
  seen[at] = (float4)(0, 0, as_float(NO_TRIANGLE), 0);
  place[at] = (float4)(0.0f);
  if (throughput[i].x == 0) return;
  const Trees trees = {top, nodes, blocks, instances};
  const float3 d = direction[i].xyz;
  Hit hit;
  Surface s;
  const Cutouts cutouts = {instances, materials, textures, texels, triangles, vertices, second_uvs};
  const float t = seen_surface(trees, cutouts, sees_through_glass, origin[i].xyz, d, &hit, &s);
  if (hit.triangle == NO_TRIANGLE) return;
  distance[at] = t;
  depth[at] = t * (c.to_world[2] * d.x + c.to_world[6] * d.y + c.to_world[10] * d.z);
  instance[at] = instances[hit.instance].visual;
  vstore3(dot(s.shading, d) < 0 ? s.shading : -s.shading, at, normal);
  seen[at] = (float4)(hit.u, hit.v, as_float(hit.triangle), as_float(hit.instance));
  place[at] = (float4)(s.point, t);
}
