// Light tracing, stage 2, once per segment after `intersect`: mirror-like surfaces send the path on; where a surface scatters,
// a shadow ray asks whether the camera sees that point, and the path goes on by a sample of the material. A path whose
// first surface scatters ends: light samples find that light. What the camera sees of light that a path brings:
//   f cos_s / cos * |cos_camera| / distance^2 * pixels / sr,   cos_s: of the shading normal, as in the camera's own paths
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/interact.cl"
#include "render/met_surface.cl"

// What interpolated normals do to light on its way from a lamp (Veach 1997, section 5.3): in, out: directions before and
// after the surface
static inline float adjoint_share(const float3 face, const float3 normal, const float3 in, const float3 out) {
  const float above = fabs(dot(normal, in) * dot(face, out)), below = fabs(dot(face, in) * dot(normal, out));
  return below > 0 ? above / below : 0.0f;
}

static inline void pass_mirror(const MetSurface met, const Surface s, const Chance chance, Path* path) {
  const float3 in = path->direction;
  float3 normal = met.normal;
  if (met.material.kind == MATERIAL_DIELECTRIC) {
    normal = pass_glass(met.material, met.boundary, s, met.face, met.normal, chance.material_choice, path);
  } else {
    const Frame frame = make_frame(normal);
    scatter(met.material, met.boundary, s, met.face, frame, to_local(frame, -in), chance, path);
  }
  path->throughput *= adjoint_share(met.face, normal, in, path->direction);
}

static inline float largest_of(const float3 v) { return max(v.x, max(v.y, v.z)); }

// the point of the lens that looks; in the camera's frame
static inline float3 point_of_lens(const Launch launch, const uint2 stream) {
  const float radius = launch.camera.lens_radius;
  return radius > 0 ? (float3)(radius * uniform_disc(sample_2d(stream.x, stream.y, 1u << 16)), 0.0f) : (float3)(0.0f);
}

// The surface as the camera meets it; nothing where it does not see the point. shadow->weight: number of the pixel
static inline void join_camera(const Launch launch, const Shading scene, global const Instance* instance,
                               const uint triangle, const Material m, const float3 color, const Surface s,
                               const float3 lens, const Path* path, ShadowRay* shadow) {
  const PinholeCamera c = launch.camera;
  const float3 eye = camera_vector(c, lens) + (float3)(c.to_world[3], c.to_world[7], c.to_world[11]);
  const float3 to_eye = eye - s.point, toward = unit(to_eye);
  const float3 seen = in_camera(c, s.point) - lens;
  float2 pixel;
  if (!seen_at(c, lens, seen, &pixel)) return;
  const float2 place = floor(pixel + 0.5f);
  if (!(place.x >= 0 && place.y >= 0 && place.x < (float)c.width && place.y < (float)c.height)) return;
  if (c.is_distorted || c.model == CAMERA_FISHEYE) {
    // distortion may fold back what lies beyond the picture
    float3 back;
    if (!pixel_direction(c, pixel, &back)) return;
    const float3 middle = c.lens_radius > 0 ? lens + seen * (c.focus_distance / seen.z) : seen;
    if (!(dot(unit(back), unit(middle)) > 0.9999f)) return;
  }
  const MetSurface met = met_surface(scene, instance, triangle, m, color, s, -toward, launch.media);
  if (met.boundary.is_hidden) return;
  const float3 to_lamp = -path->direction;
  const float side = dot(met.face, to_lamp);
  if (!(side > 0)) return;
  const Frame frame = make_frame(met.normal);
  const float3 wo = to_local(frame, toward), wi = to_local(frame, to_lamp);
  if (wi.z <= 0) return;
  const float3 f = material_eval(met.material, wo, wi);
  if (!(f.x + f.y + f.z > 0)) return;
  const float cosine = light_cosine(s, to_lamp);
  const float weight = traced_weight(launch.light_paths_per_sample * path->density,
                                     camera_density(launch, s) * material_pdf(met.material, wo, wi) / cosine);
  // the camera's paths carry radiance / n^2
  const uint medium = media_current(launch.media, scene.materials);
  const float n = medium_ior(medium, scene.materials), d2 = dot(to_eye, to_eye);
  shadow->light = path->throughput * f * media_transmission(launch.media, scene.materials, sqrt(d2)) *
                  (weight * fabs(dot(s.face, toward)) * pixels_per_steradian(c, lens, unit(seen)) /
                   (cosine * d2 * n * n * (float)launch.n_light_paths * launch.receiver_scale));
  shadow->kind = SHADOW_SURFACE;
  shadow->origin = leave_surface(s.point, met.face);
  shadow->direction = to_eye - (shadow->origin - s.point);
  shadow->weight = as_float((uint)place.y * c.width + (uint)place.x);
}

// The path goes on with a chance that is the share of the light which the surface scatters.
static inline void scatter_light(const MetSurface met, const Surface s, const Chance chance, Path* path) {
  const float3 in = path->direction;
  const float before = largest_of(path->throughput);
  const Frame frame = make_frame(met.normal);
  scatter(met.material, met.boundary, s, met.face, frame, to_local(frame, -in), chance, path);
  const float survival = min(1.0f, largest_of(path->throughput) / before);
  path->is_alive = path->is_alive && chance.roulette < survival;
  path->throughput *= adjoint_share(met.face, met.normal, in, path->direction) / survival;
  path->density *= scattered_ratio(met.material, s, frame, in, path->direction, path->pdf);
  path->density = fmin(path->density, MOST_DENSITY);
}

static inline void follow_path(const Launch launch, const Shading scene, const uint2 stream, const uint depth,
                               const float4 hit, const uint hit_instance, Path* path, ShadowRay* shadow) {
  global const Instance* instance = scene.instances + hit_instance;
  const uint triangle = as_uint(hit.w);
  path->is_alive = false;
  if (triangle == NO_TRIANGLE || instance->visual == 0 || depth >= launch.max_depth) return;
  const Material m = scene.materials[instance->material];
  if (m.kind == MATERIAL_SHADOW_RECEIVER || m.kind == MATERIAL_EMISSIVE) return;
  const Surface s = surface_with_uvs(scene, hit_instance, triangle, hit.y, hit.z);
  const bool enters = dot(s.face, path->direction) < 0;
  // a solid that it never entered: the lamp is inside of it
  if ((m.flags & MATERIAL_HAS_INSIDE) && !enters && !media_holds(path->media, instance->material)) return;
  path->throughput *= media_transmission(path->media, scene.materials, hit.x + ray_offset(s.point));
  const float3 color = surface_color(scene, instance, m, s, triangle, hit.y, hit.z);
  const MetSurface met = met_surface(scene, instance, triangle, m, color, s, path->direction, path->media);
  if (met.boundary.is_hidden) {
    path->is_alive = true;
    pass_hidden(met.boundary, s, met.face, path);
  } else if (!material_scatters(met.material)) {
    path->is_alive = true;
    pass_mirror(met, s, draw_chance(stream, depth), path);
  } else if (depth > 0 && !material_transmits(met.material)) {
    if (media_current(path->media, scene.materials) == media_current(launch.media, scene.materials))
      join_camera(launch, scene, instance, triangle, m, color, s, point_of_lens(launch, stream), path, shadow);
    path->is_alive = true;
    scatter_light(met, s, draw_chance(stream, depth), path);
  }
}

// as in emit.cl and shade_path.cl;  radiance: w: density of the path;  shadow_direction: w: number of the pixel, as bits;
// shadow_light: in units of white, over all light paths of the picture
kernel void follow(const uint n, const Launch launch, const uint depth, global const uint* restrict queue,
                   global const uint2* restrict stream, global const Instance* restrict instances,
                   global const Material* restrict materials, global const TextureInfo* restrict textures,
                   global const uchar4* restrict texels, constant float* restrict decode,
                   global const uint* restrict triangles, global const Vertex* restrict vertices,
                   global const float* restrict colors, global const float* restrict second_uvs,
                   global const float4* restrict hit, global const uint* restrict hit_instance,
                   global float4* restrict radiance, global float4* restrict origin,
                   global float4* restrict direction, global float4* restrict throughput,
                   global float4* restrict shadow_origin, global float4* restrict shadow_direction,
                   global float4* restrict shadow_light, global uint* restrict alive) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint slot = queue[i];
  Path path = load_path(slot, origin, direction, throughput);
  ShadowRay shadow = {0.0f, 0.0f, 0.0f, 0.0f, SHADOW_NONE};
  const Shading scene = {instances, materials, textures,   texels, decode, triangles,
                         vertices,  colors,    second_uvs, 0,      0,      0,         0};
  path.density = radiance[slot].w;
  follow_path(launch, scene, stream[slot], depth, hit[slot], hit_instance[slot], &path, &shadow);
  radiance[slot].w = path.density;
  alive[i] = path.is_alive ? 1u : 0u;
  origin[slot] = (float4)(path.origin, path.pdf);
  direction[slot] = (float4)(path.direction, as_float(path.media));
  throughput[slot] = (float4)(path.throughput, as_float(path.flags));
  shadow_origin[slot] = (float4)(shadow.origin, as_float(shadow.kind));
  if (shadow.kind == SHADOW_NONE) return;
  shadow_direction[slot] = (float4)(shadow.direction, shadow.weight);
  shadow_light[slot] = (float4)(shadow.light, 0);
}
