// What may happen to a path where it hits, one function per case: a light, a shadow receiver, glass, a surface that
// scatters. How light samples and paths share the work is told in shade.cl.
#ifndef PVG_RENDER_INTERACT_CL
#define PVG_RENDER_INTERACT_CL
#include "materials/list.cl"
#include "render/lights.cl"
#include "render/media.cl"
#include "render/surface.cl"

// what one shadow ray is to bring; kind SHADOW_NONE: no ray
typedef struct {
  float3 origin, direction;  // direction reaches to the light
  float3 light;              // added if nothing is between
  float weight;              // of the heuristic, where no glass is between
  uint kind;
} ShadowRay;

typedef struct {
  float3 origin, direction, throughput, radiance;
  float pdf;   // of the last direction, 0: mirror-like
  uint flags;  // PATH_...
  uint media;
  bool is_alive;
} Path;

// radiance of a light that a path met
inline void meet_light(const Launch launch, global const Light* light, const Surface s, const float t, Path* path) {
  path->is_alive = false;
  if (dot(s.face, path->direction) >= 0) return;
  float weight = 1.0f;
  if (path->flags & PATH_SCATTERED) {
    if (path->pdf > 0)
      weight = mis_weight(path->pdf, light_pdf(light, path->direction * t));
    else if (launch.transparent_shadows && (path->flags & PATH_DIFFUSE) && (path->flags & PATH_REFRACTED))
      weight = 0.0f;
  }
  path->radiance += path->throughput * vload3(0, light->radiance) * weight;
}

inline void meet_receiver(const Launch launch, const Material m, const float3 color, const Surface s,
                          global const Light* lights, const float2 u, Path* path, ShadowRay* shadow) {
  path->is_alive = false;
  const float3 shown = path->throughput * color * launch.receiver_scale;
  path->radiance += shown * (1.0f - m.shadow_strength);
  const float3 shaded = shown * m.shadow_strength;
  if (m.shadow_strength == 0) return;
  if (launch.n_lights > 0) {
    const float3 normal = dot(s.face, path->direction) < 0 ? s.face : -s.face;
    const LightSample sample = sample_light(lights, launch.n_lights, u);
    const float3 origin = leave_surface(s.point, normal), to_light = sample.point - origin;
    // a light that cannot shine here casts no shadow here
    if (dot(normal, to_light) > 0 && light_pdf(lights + sample.index, to_light) > 0) {
      shadow->kind = SHADOW_RECEIVER;
      shadow->origin = origin;
      shadow->direction = to_light;
      shadow->light = shaded;
      shadow->weight = 1.0f;
      return;
    }
  }
  path->radiance += shaded;
}

// one light sample, weighted against the material's own sampling
inline void light_surface(const Launch launch, const Material m, const float3 color, const Surface s,
                          const float3 normal, const Frame frame, const float3 wo, global const Light* lights,
                          const float2 u, const Path* path, ShadowRay* shadow) {
  if (launch.n_lights == 0 || !material_scatters(m)) return;
  const LightSample sample = sample_light(lights, launch.n_lights, u);
  const float3 origin = leave_surface(s.point, normal), to_light = sample.point - origin;
  const float pdf = light_pdf(lights + sample.index, to_light);
  if (!(pdf > 0) || dot(normal, to_light) <= 0) return;
  const float3 wi = to_local(frame, normalize(to_light));
  const float3 f = material_eval(m, color, wo, wi);
  if (f.x + f.y + f.z <= 0) return;
  shadow->kind = m.kind == MATERIAL_DIFFUSE && launch.transparent_shadows ? SHADOW_SURFACE_GLASS : SHADOW_SURFACE;
  shadow->origin = origin;
  shadow->direction = to_light;
  shadow->light = path->throughput * f * vload3(0, lights[sample.index].radiance) / pdf;
  shadow->weight = mis_weight(pdf, material_pdf(m, wo, wi));
}

// reflection and refraction at glass
inline void pass_glass(const uint material, global const Material* materials, const Surface s, const float u,
                       Path* path) {
  const bool enters = dot(s.face, path->direction) < 0;
  const float3 face = enters ? s.face : -s.face;
  float3 normal = enters ? s.shading : -s.shading;
  if (dot(normal, path->direction) >= 0) normal = face;  // a shading normal that looks away cannot be used
  const uint inner = enters ? media_enter(path->media, material) : media_leave(path->media, material);
  const float outside = enters ? media_ior(path->media, materials) : materials[material].ior;
  const float eta = media_ior(inner, materials) / outside;
  Frame frame = make_frame(normal);
  MaterialSample sample = dielectric_sample(eta, to_local(frame, -path->direction), u);
  const bool is_refracted = sample.direction.z < 0;
  float3 direction = to_world(frame, sample.direction);
  if ((dot(direction, face) < 0) != is_refracted) {
    // the bent direction is on the wrong side of the true surface: once more with the true normal, same choice
    frame = make_frame(face);
    const float3 wo = to_local(frame, -path->direction);
    sample = dielectric_sample(eta, wo, is_refracted ? 1.0f : 0.0f);
    direction = to_world(frame, sample.direction);
  }
  const bool passes = dot(direction, face) < 0;  // not so at total reflection
  path->origin = leave_surface(s.point, passes ? -face : face);
  path->direction = normalize(direction);
  path->pdf = 0.0f;
  if (!passes) return;
  path->flags |= PATH_REFRACTED;
  path->media = inner;
}

inline void scatter(const Material m, const float3 color, const Surface s, const float3 normal, const Frame frame,
                    const float3 wo, const float2 u, Path* path) {
  const MaterialSample sample = material_sample(m, color, 1.0f, wo, u);
  const float3 direction = to_world(frame, sample.direction);
  path->throughput *= sample.weight;
  path->is_alive = dot(direction, normal) > 0;  // else an interpolated normal sent it into the surface
  path->origin = leave_surface(s.point, normal);
  path->direction = normalize(direction);
  path->pdf = sample.pdf;
  if (!material_scatters(m)) return;
  path->flags = PATH_SCATTERED | (m.kind == MATERIAL_DIFFUSE ? PATH_DIFFUSE : 0u);
}

// paths that carry little end early, the others carry more for them
inline void roulette(const uint depth, const float u, Path* path) {
  const float largest = max(path->throughput.x, max(path->throughput.y, path->throughput.z));
  if (!(largest > 0)) path->is_alive = false;
  if (depth < 2 || !path->is_alive || largest >= 1.0f) return;
  const float survival = max(largest, 0.05f);
  if (u >= survival) path->is_alive = false;
  path->throughput /= survival;
}
#endif
