// Stage 3: what happens where a path hit. Adds what the surface itself shines, sends one shadow ray toward a light, and
// continues the path by a sample of the material.
//   light that a path meets: weighted against the light samples of the last scattering surface (power heuristic)
//   glass between a diffuse surface and a light: shadow rays pass straight through, attenuated (transmittance.cl), and
//     the refracted paths to that light are left out, so that no light is counted twice. Rough conductors keep the
//     refracted paths and their shadow rays stop at glass. Launch::transparent_shadows = 0: glass stops all shadow rays
//     and every refracted path counts
//   shadow receiver: C = C_tex (1 - lambda_s (1 - V)), and the path ends; V from one light sample per path
#include "materials/texture.cl"
#include "render/interact.cl"
#include "render/tiles.cl"
#include "shared/rng.cl"

inline Path load_path(const uint slot, global const float4* origin, global const float4* direction,
                      global const float4* throughput) {
  const float4 o = origin[slot], d = direction[slot], t = throughput[slot];
  Path path;
  path.origin = o.xyz;
  path.pdf = o.w;
  path.direction = d.xyz;
  path.media = as_uint(d.w);
  path.throughput = t.xyz;
  path.flags = as_uint(t.w);
  path.radiance = 0.0f;
  path.is_alive = true;
  return path;
}

// what shading reads of the scene
typedef struct {
  global const Instance* instances;
  global const Material* materials;
  global const TextureInfo* textures;
  global const uchar4* texels;
  constant float* decode;
  global const uint* triangles;
  global const Vertex* vertices;
  global const Light* lights;
} Shading;

// a diffuse or conducting surface: light sample, then the path goes on
inline void meet_scatterer(const Launch launch, const Shading scene, const Material m, const float3 color,
                           const Surface s, const uint key, const uint sample, const uint dimension, Path* path,
                           ShadowRay* shadow) {
  const float3 face = dot(s.face, path->direction) < 0 ? s.face : -s.face;
  float3 normal = dot(s.shading, face) > 0 ? s.shading : -s.shading;
  if (dot(normal, path->direction) >= 0) normal = face;  // a shading normal that looks away cannot be used
  const Frame frame = make_frame(normal);
  const float3 wo = to_local(frame, -path->direction);
  light_surface(launch, m, color, s, face, frame, wo, scene.lights, sample_2d(key, sample, dimension), path, shadow);
  scatter(m, color, s, face, frame, wo, sample_2d(key, sample, dimension + 1), path);
}

// hit: t, u, v, triangle
inline void meet_surface(const Launch launch, const Shading scene, const uint slot, const uint depth, const float4 hit,
                         const uint hit_instance, Path* path, ShadowRay* shadow) {
  global const Instance* instance = scene.instances + hit_instance;
  const Surface s = surface_at(instance, scene.triangles, scene.vertices, as_uint(hit.w), hit.y, hit.z);
  path->throughput *= media_transmission(path->media, scene.materials, hit.x + ray_offset(s.point));
  if (instance->light >= 0) {
    meet_light(launch, scene.lights + instance->light, s, hit.x, path);
    return;
  }
  const Material m = scene.materials[instance->material];
  const float3 texture =
      m.texture >= 0 ? texture_color(scene.textures[m.texture], scene.texels, scene.decode, s.uv) : (float3)(1.0f);
  const float3 color = vload3(0, m.color) * texture;
  const uint sample = slot % launch.n_samples;
  const uint2 pixel =
      tile_pixel(launch.first_pixel + slot / launch.n_samples, launch.camera.width, launch.camera.height);
  const uint key = hash_combine(launch.key, pixel.y * launch.camera.width + pixel.x);
  const uint dimension = 1 + 3 * depth;
  if (m.kind == MATERIAL_EMISSIVE) {
    path->radiance = path->throughput * vload3(0, m.emission) * texture;
    path->is_alive = false;
  } else if (m.kind == MATERIAL_SHADOW_RECEIVER) {
    meet_receiver(launch, m, color, s, scene.lights, sample_2d(key, sample, dimension), path, shadow);
  } else if (depth >= launch.max_depth) {
    path->is_alive = false;
  } else {
    if (m.kind == MATERIAL_DIELECTRIC)
      pass_glass(instance->material, scene.materials, s, sample_2d(key, sample, dimension + 1).x, path);
    else
      meet_scatterer(launch, scene, m, color, s, key, sample, dimension, path, shadow);
    roulette(depth, sample_1d(key, sample, dimension + 2), path);
  }
}

// as in generate.cl and intersect.cl;  shadow_origin: [n_slots, m], w: kind;  shadow_direction: [n_slots, m] to the
// light;  shadow_light: [n_slots], w: weight;  alive: [n] by place in the queue;  depth: bounces so far
kernel void shade(const uint n, const Launch launch, const uint depth, global const uint* restrict queue,
                  global const Instance* restrict instances, global const Material* restrict materials,
                  global const TextureInfo* restrict textures, global const uchar4* restrict texels,
                  constant float* restrict decode, global const uint* restrict triangles,
                  global const Vertex* restrict vertices, global const Light* restrict lights,
                  global const float4* restrict hit, global const uint* restrict hit_instance,
                  global float4* restrict origin, global float4* restrict direction, global float4* restrict throughput,
                  global float4* restrict radiance, global float4* restrict shadow_origin,
                  global float4* restrict shadow_direction, global float4* restrict shadow_light,
                  global uint* restrict alive) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint slot = queue[i];
  Path path = load_path(slot, origin, direction, throughput);
  ShadowRay shadow = {0.0f, 0.0f, 0.0f, 0.0f, SHADOW_NONE};
  if (as_uint(hit[slot].w) == NO_TRIANGLE) {
    path.radiance = path.throughput * vload3(0, launch.environment);
    path.is_alive = false;
  } else {
    const Shading scene = {instances, materials, textures, texels, decode, triangles, vertices, lights};
    meet_surface(launch, scene, slot, depth, hit[slot], hit_instance[slot], &path, &shadow);
  }
  radiance[slot] += (float4)(path.radiance, 0);
  alive[i] = path.is_alive ? 1u : 0u;
  if (path.is_alive) {
    origin[slot] = (float4)(path.origin, path.pdf);
    direction[slot] = (float4)(path.direction, as_float(path.media));
    throughput[slot] = (float4)(path.throughput, as_float(path.flags));
  }
  shadow_origin[slot] = (float4)(shadow.origin, as_float(shadow.kind));
  if (shadow.kind == SHADOW_NONE) return;
  shadow_direction[slot] = (float4)(shadow.direction, 0);
  shadow_light[slot] = (float4)(shadow.light, shadow.weight);
}
