// Light tracing, stage 1: paths leave the lamps toward what is mirror-like. A lamp is chosen by its share of the power, a
// point evenly on it, a direction as light_tracing.cl says.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/light_tracing.cl"
#include "shared/rng.cl"

typedef struct {
  float3 point, normal;  // normal: on the side that the light leaves
  float3 radiance;
  float area;
} Emitter;

static inline Emitter point_of_lamp(const Shading scene, global const Light* light, const float2 u) {
  Emitter e;
  e.radiance = vload3(0, light->radiance);
  e.area = light->area;
  if (light->kind == LIGHT_SPHERE) {
    const float z = 1.0f - 2.0f * u.x, r = sqrt(max(0.0f, 1.0f - z * z)), phi = 2.0f * M_PI_F * u.y;
    e.normal = (float3)(r * cos(phi), r * sin(phi), z);
    e.point = vload3(0, light->corner) + light->radius * e.normal;
    return e;
  }
  if (light->kind == LIGHT_TRIANGLE) {
    global const Instance* instance = scene.instances + light->instance;
    float3 p[3];
    world_triangle(scene, instance, light->triangle, p);
    const float root = sqrt(u.x), b = root * u.y, a = 1.0f - root, c = 1.0f - a - b;
    e.point = a * p[0] + c * p[1] + b * p[2];
    e.normal = cross(p[1] - p[0], p[2] - p[0]);
    const float twice_area = length(e.normal);
    e.area = 0.5f * twice_area;
    e.normal = unit(e.normal);
    const Material m = scene.materials[instance->material];
    const Cutouts cutouts = cutouts_of(scene);
    e.radiance = emitted(scene, m, texture_uv(cutouts, instance, m.flags, emission_bit(m), light->triangle, c, b));
    if (instance->flags & INSTANCE_CUTOUT) e.radiance *= 1.0f - opening(cutouts, light->instance, light->triangle, c, b);
    return e;
  }
  e.point = vload3(0, light->corner) + u.x * vload3(0, light->edge_u) + u.y * vload3(0, light->edge_v);
  e.normal = vload3(0, light->normal);
  return e;
}

// from the point of a sphere to outside of its triangles, on the same line
static inline float3 leave_sphere(const float radius, const float3 point, const float cosine, const float3 direction) {
  const float rise = cosine * radius;
  return point + direction * (sqrt(rise * rise + (SPHERE_SHELL * SPHERE_SHELL - 1.0f) * radius * radius) - rise);
}

// Launch::first_sample: number of the first path. targets: [n_targets] centre, w: radius [m];  throughput: [n] radiance over
// density;  radiance: [n] w: emission_density;  alive: [n] 0 where nothing leaves. Else as in generate.cl and shade_path.cl
kernel void emit(const uint n, const Launch launch, global const Instance* restrict instances,
                 global const Material* restrict materials, global const TextureInfo* restrict textures,
                 global const uchar4* restrict texels, constant float* restrict decode,
                 global const uint* restrict triangles, global const Vertex* restrict vertices,
                 global const float* restrict second_uvs, global const Light* restrict lights,
                 global const float4* restrict targets, global float4* restrict origin,
                 global float4* restrict direction, global float4* restrict throughput,
                 global float4* restrict radiance, global uint2* restrict stream, global uint* restrict queue,
                 global uint* restrict alive) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Shading scene = {instances, materials,  textures, texels, decode, triangles,
                         vertices,  0,          second_uvs, lights, 0,    0,         targets};
  const uint path = launch.first_sample + i, key = hash_combine(launch.key, LIGHT_PATH_KEY);
  queue[i] = i;
  stream[i] = (uint2)(key, path);
  alive[i] = 0;
  float rest;
  global const Light* light = choose_light(launch, scene, sample_2d(key, path, 0), &rest);
  if (light->kind == LIGHT_ENVIRONMENT) return;
  const Emitter e = point_of_lamp(scene, light, sample_2d(key, path, 1));
  const float3 d = aim(launch, targets, e.point, sample_2d(key, path, 2), sample_2d(key, path, 3).x);
  float cosine = dot(e.normal, d);
  float3 L = e.radiance;
  if (light->kind == LIGHT_SPHERE) L *= spot_share(light, d);
  if (light->kind == LIGHT_TRIANGLE) cosine = fabs(cosine);
  const float density = emission_density(launch, scene, light->probability, e.area, e.point, cosine, d);
  if (!(density > 0) || !(L.x + L.y + L.z > 0)) return;
  const float3 from = light->kind == LIGHT_SPHERE
                          ? leave_sphere(light->radius, e.point, cosine, d)
                          : leave_surface(e.point, dot(e.normal, d) > 0 ? e.normal : -e.normal);
  origin[i] = (float4)(from, 0);
  direction[i] = (float4)(d, as_float(0u));
  throughput[i] = (float4)(L / density, as_float(0u));
  radiance[i] = (float4)(0, 0, 0, density);
  alive[i] = 1;
}
