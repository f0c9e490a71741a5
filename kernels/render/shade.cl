// Stage 3: what happens where a path hit. Adds what the surface itself shines, sends one shadow ray toward a light, and
// continues the path by a sample of the material.
//   light that a path meets: weighted against the light samples of the last scattering surface (power heuristic)
//   clear glass between a matte surface and a light: shadow rays pass straight through, attenuated (transmittance.cl), and
//     the refracted paths to that light are left out, so that no light is counted twice. Other surfaces keep the
//     refracted paths and their shadow rays stop at glass. Launch::transparent_shadows = 0: glass stops all shadow rays
//     and every refracted path counts
//   shadow receiver: its texture, dimmed by the shadows of inserted objects (receiver.cl)
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/interact.cl"
#include "render/receiver.cl"

static inline Path load_path(const uint slot, global const float4* origin, global const float4* direction,
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

static inline float3 texture_at(const Shading scene, const int texture, const float2 uv) {
  return texture < 0 ? (float3)(1.0f)
                     : texture_color(scene.textures[texture], scene.texels, scene.decode, uv);
}

// the texture coordinates of a triangle's corners that lay out the normal map
static inline void normal_map_corners(const Shading scene, global const Instance* instance, const uint flags,
                                      const uint triangle, float2 uv[3]) {
  const uint3 corner = vload3(triangle, scene.triangles);
  const uint corners[3] = {corner.x, corner.y, corner.z};
  const bool is_second = (flags & SECOND_UVS_NORMAL) && (instance->flags & INSTANCE_SECOND_UVS);
  for (int k = 0; k < 3; ++k)
    uv[k] = is_second ? second_uv_of_corner(instance, scene.second_uvs, corners[k])
                      : vload2(0, scene.vertices[corners[k]].uv);
}

static inline PointMaterial material_at(const Shading scene, const Material m, const float3 color, const Surface s,
                                        const float eta) {
  PointMaterial p = point_material(m, eta);
  p.color = color;
  if (m.metallic_roughness_texture >= 0) {
    const float3 t = texture_at(scene, m.metallic_roughness_texture, uv_for(s, m.flags, SECOND_UVS_METALLIC_ROUGHNESS));
    p.alpha = max(MIRROR_ALPHA, p.alpha * t.y * t.y);
    p.metallic *= t.z;
  }
  return p;
}

// glass or a surface that scatters: light sample, then the path goes on. triangle: index into those of all meshes
static inline void meet_surface(const Launch launch, const Shading scene, global const Instance* instance,
                                const uint triangle, const Material m, const float3 color, const Surface s,
                                const Chance chance, Path* path, ShadowRay* shadow) {
  const bool enters = dot(s.face, path->direction) < 0;
  const float3 face = enters ? s.face : -s.face;
  Boundary boundary = {m.ior, path->media, false};
  if (m.flags & MATERIAL_HAS_INSIDE)
    boundary = boundary_of(path->media, instance->material, scene.materials, enters);
  if (boundary.is_hidden) {
    pass_hidden(boundary, s, face, path);
    return;
  }
  float3 normal = dot(s.shading, face) > 0 ? s.shading : -s.shading;
  if (m.normal_texture >= 0) {
    const float3 bend = 2.0f * texture_at(scene, m.normal_texture, uv_for(s, m.flags, SECOND_UVS_NORMAL)) - 1.0f;
    float2 corner_uvs[3];
    normal_map_corners(scene, instance, m.flags, triangle, corner_uvs);
    // on the back of a surface the map's directions along it stay
    normal = bent_normal(instance, scene.triangles, scene.vertices, triangle, corner_uvs, normal,
                         (float3)(bend.xy * m.normal_scale, bend.z));
  }
  if (dot(normal, path->direction) >= 0) normal = face;  // a shading normal that looks away cannot be used
  const PointMaterial p = material_at(scene, m, color, s, boundary.eta);
  if (p.kind == MATERIAL_DIELECTRIC) {
    pass_glass(p, boundary, s, face, normal, chance.material_choice, path);
    return;
  }
  const Frame frame = make_frame(normal);
  const float3 wo = to_local(frame, -path->direction);
  light_surface(launch, scene, p, s, face, frame, wo, chance, path, shadow);
  scatter(p, boundary, s, face, frame, wo, chance, path);
}

// hit: t, u, v, triangle
static inline void meet(const Launch launch, const Shading scene, const Chance chance, const uint depth,
                        const float4 hit, const uint hit_instance, Path* path, ShadowRay* shadow) {
  global const Instance* instance = scene.instances + hit_instance;
  const uint triangle = as_uint(hit.w);
  const Surface s = surface_with_uvs(scene, hit_instance, triangle, hit.y, hit.z);
  path->throughput *= media_transmission(path->media, scene.materials, hit.x + ray_offset(s.point));
  if (instance->visual == 0) {
    meet_light(launch, scene.lights + instance->light, s, hit.x, path);
    return;
  }
  const Material m = scene.materials[instance->material];
  if (m.flags & MATERIAL_EMITS) meet_shining(launch, scene, instance, m, triangle, s, hit.x, path);
  float3 color = vload3(0, m.color);
  if (m.kind != MATERIAL_EMISSIVE) color *= texture_at(scene, m.texture, uv_for(s, m.flags, SECOND_UVS_COLOR));
  if (instance->flags & INSTANCE_COLORS)
    color *= vertex_color(instance, scene.triangles, scene.colors, triangle, hit.y, hit.z);
  if (m.kind == MATERIAL_SHADOW_RECEIVER) {
    meet_receiver(launch, scene, m, color, s, chance, path, shadow);
  } else if (m.kind == MATERIAL_EMISSIVE || depth >= launch.max_depth) {
    path->is_alive = false;
  } else {
    meet_surface(launch, scene, instance, triangle, m, color, s, chance, path, shadow);
    roulette(depth, chance.roulette, path);
  }
}

// as in generate.cl and intersect.cl;  shadow_origin: [n_slots, m], w: kind;  shadow_direction: [n_slots, m] to the
// light;  shadow_light: [n_slots], w: weight;  alive: [n] by place in the queue;  depth: bounces so far
kernel void shade(const uint n, const Launch launch, const uint depth, global const uint* restrict queue,
                  global const uint2* restrict stream, global const Instance* restrict instances,
                  global const Material* restrict materials,
                  global const TextureInfo* restrict textures, global const uchar4* restrict texels,
                  constant float* restrict decode, global const uint* restrict triangles,
                  global const Vertex* restrict vertices, global const float* restrict colors,
                  global const float* restrict second_uvs, global const Light* restrict lights,
                  global const float* restrict environment, global const EnvironmentCell* restrict cells,
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
  const Shading scene = {instances, materials, textures,   texels, decode,      triangles,
                         vertices,  colors,    second_uvs, lights, environment, cells};
  if (as_uint(hit[slot].w) == NO_TRIANGLE)
    meet_environment(launch, scene, &path);
  else
    meet(launch, scene, draw_chance(stream[slot], depth), depth, hit[slot], hit_instance[slot], &path, &shadow);
  if (any(path.radiance != 0.0f)) radiance[slot] += (float4)(path.radiance, 0);
  alive[i] = path.is_alive ? 1u : 0u;
  // also of paths that end, which no one reads: cheaper than a branch that is hard to foresee
  origin[slot] = (float4)(path.origin, path.pdf);
  direction[slot] = (float4)(path.direction, as_float(path.media));
  throughput[slot] = (float4)(path.throughput, as_float(path.flags));
  shadow_origin[slot] = (float4)(shadow.origin, as_float(shadow.kind));
  if (shadow.kind == SHADOW_NONE) return;
  shadow_direction[slot] = (float4)(shadow.direction, 0);
  shadow_light[slot] = (float4)(shadow.light, shadow.weight);
}
