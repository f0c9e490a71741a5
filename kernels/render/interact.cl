// What may happen to a path where it hits, one function per case: a light, glass, a surface that scatters
// (a shadow receiver: receiver.cl). How light samples and paths share the work is told in shade_path.cl.
#ifndef PVG_RENDER_INTERACT_CL
#define PVG_RENDER_INTERACT_CL
#include "materials/list.cl"
#include "render/light_tracing.cl"
#include "render/lights.cl"
#include "render/media.cl"
#include "shared/rng.cl"

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
  // of light tracing (light_tracing.cl): density of this way, over what the other way has at the surfaces that scatter
  // behind its first one
  float density;
  float likelihood;  // of what it did at clear glass, over that of what it did not do; at most 1
  bool is_alive;
} Path;

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
  path.density = 0.0f;
  path.likelihood = 1.0f;
  path.is_alive = true;
  return path;
}

// the random numbers of one bounce, in [0, 1)
typedef struct {
  float2 light_point, light_choice, material_point;
  float material_choice, roulette;
} Chance;

static inline Chance draw_chance(const uint2 stream, const uint depth) {
  const float8 u = sample_2d_4(stream.x, stream.y, 2 + 4 * depth);  // 0 and 1: generate.cl
  const Chance chance = {u.s04, u.s15, u.s26, u.s3, u.s7};
  return chance;
}

// light that a path met;  pdf: with which a light sample of the last surface would have found it, 0: never;
// traced: density of the light paths that find it, over that of a camera's samples, 0: none does
static inline void meet_emission(const Launch launch, const float3 radiance, const float pdf, const float traced,
                                 Path* path) {
  float weight = 1.0f;
  if (path->flags & PATH_SCATTERED) {
    if (path->pdf > 0)
      weight = mis_weight(path->pdf, pdf);
    else if (traced > 0)
      weight = traced_weight(path->density, traced);
    else if (pdf > 0 && launch.transparent_shadows && (path->flags & PATH_DIFFUSE) && (path->flags & PATH_REFRACTED))
      weight = 0.0f;
  }
  path->radiance += path->throughput * radiance * weight;
}

static inline void meet_environment(const Launch launch, const Shading scene, Path* path) {
  path->is_alive = false;
  const float pdf = launch.environment_light < 0 ? 0.0f
                                                 : scene.lights[launch.environment_light].probability *
                                                       environment_pdf(launch, scene.cells, path->direction);
  meet_emission(launch, environment_radiance(launch, scene.environment, path->direction), pdf, 0.0f, path);
}

// a rectangle or sphere
static inline void meet_light(const Launch launch, const Shading scene, global const Light* light, const Surface s,
                              const float t, Path* path) {
  path->is_alive = false;
  if (dot(s.face, path->direction) >= 0) return;
  const bool is_sphere = light->kind == LIGHT_SPHERE;
  const float pdf = is_sphere ? sphere_pdf(light, path->origin) : rectangle_pdf(light, path->direction * t);
  const float share = is_sphere ? spot_share(light, -path->direction) : 1.0f;
  float traced = 0.0f;
  if (is_light_traced(launch, path->flags, path->pdf, path->media)) {
    const float3 away = -path->direction;
    const float cosine = is_sphere ? sphere_cosine(light, s.point, away) : dot(s.face, away);
    traced = launch.light_paths_per_sample *
             emission_density(launch, scene, light->probability, light->area, s.point, cosine, away);
  }
  meet_emission(launch, share * vload3(0, light->radiance), pdf, traced, path);
}

// a mesh that shines, on both sides
static inline void meet_shining(const Launch launch, const Shading scene, global const Instance* instance,
                                const Material m, const uint triangle, const Surface s, const float t, Path* path) {
  float pdf = 0.0f, traced = 0.0f;
  if (instance->flags & INSTANCE_SHINES) {
    float3 p[3];
    world_triangle(scene, instance, triangle, p);
    const float area = 0.5f * length(cross(p[1] - p[0], p[2] - p[0]));
    const uint light = (uint)(instance->light + (int)triangle);
    pdf = area_pdf(scene.lights[light].probability, area, fabs(dot(s.face, path->direction)), t * t);
    if (is_light_traced(launch, path->flags, path->pdf, path->media))
      traced = launch.light_paths_per_sample * emission_density(launch, scene, scene.lights[light].probability, area,
                                                                s.point, fabs(dot(s.face, path->direction)),
                                                                -path->direction);
  }
  meet_emission(launch, emitted(scene, m, uv_for(s, m.flags, emission_bit(m))), pdf, traced, path);
}

// one light sample, weighted against the material's own sampling
static inline void light_surface(const Launch launch, const Shading scene, const PointMaterial m, const Surface s,
                                 const float3 face, const Frame frame, const float3 wo, const Chance chance,
                                 const Path* path, ShadowRay* shadow) {
  if (launch.n_lights == 0 || !material_scatters(m)) return;
  const LightSample sample = sample_light(launch, scene, s.point, chance.light_choice, chance.light_point);
  const float side = dot(face, sample.to_light);
  if (!(sample.pdf > 0) || side == 0 || (side < 0 && !material_transmits(m))) return;
  const float3 wi = to_local(frame, unit(sample.to_light));
  if (wi.z * side <= 0) return;  // an interpolated normal would let light through the surface
  const float3 f = material_eval(m, wo, wi);
  if (f.x + f.y + f.z <= 0) return;
  shadow->kind = material_is_matte(m) && launch.transparent_shadows ? SHADOW_SURFACE_GLASS : SHADOW_SURFACE;
  shadow->origin = leave_surface(s.point, side > 0 ? face : -face);
  shadow->direction = sample.to_light - (shadow->origin - s.point);
  shadow->light = path->throughput * f * sample.radiance / sample.pdf;
  shadow->weight = mis_weight(sample.pdf, material_pdf(m, wo, wi));
}

// The solid behind this surface is not there, see media.cl: the path goes straight on, as if through clear glass.
static inline void pass_hidden(const Boundary boundary, const Surface s, const float3 face, Path* path) {
  path->origin = leave_surface(s.point, -face);
  path->pdf = 0.0f;
  path->flags |= PATH_REFRACTED;
  path->media = boundary.inner;
}

// reflection and refraction at clear glass, solid or thin; normal and face look to the path. Returns the normal that
// bent it
static inline float3 pass_glass(const PointMaterial m, const Boundary boundary, const Surface s, const float3 face,
                              const float3 normal, const float choice, Path* path) {
  Frame frame = make_frame(normal);
  const float3 wo = to_local(frame, -path->direction);
  MaterialSample sample = material_sample(m, wo, (float2)(0.0f), choice);
  const bool is_refracted = sample.direction.z < 0;
  const float reflectance = dielectric_reflectance(m, wo), share = is_refracted ? 1.0f - reflectance : reflectance;
  path->likelihood = fmin(1.0f, share / (1.0f - share));
  float3 direction = to_world(frame, sample.direction);
  if ((dot(direction, face) < 0) != is_refracted) {
    // The bent direction is on the wrong side of the true surface: once more with the true normal, same choice. Not 1,
    // which would refract at total reflection, along the surface: rounding would choose its side
    frame = make_frame(face);
    sample = material_sample(m, to_local(frame, -path->direction), (float2)(0.0f), is_refracted ? 0x1.fffffep-1f : 0.0f);
    direction = to_world(frame, sample.direction);
  }
  const bool passes = dot(direction, face) < 0;  // not so at total reflection
  path->origin = leave_surface(s.point, passes ? -face : face);
  path->direction = unit(direction);
  path->throughput *= sample.weight;
  path->pdf = 0.0f;
  if (passes) {
    path->flags |= PATH_REFRACTED;
    if (m.flags & MATERIAL_HAS_INSIDE) path->media = boundary.inner;
  }
  return frame.z;
}

static inline void scatter(const PointMaterial m, const Boundary boundary, const Surface s, const float3 face,
                           const Frame frame, const float3 wo, const Chance chance, Path* path) {
  const MaterialSample sample = material_sample(m, wo, chance.material_point, chance.material_choice);
  const float3 direction = to_world(frame, sample.direction);
  const bool passes = sample.direction.z < 0;
  path->throughput *= sample.weight;
  path->is_alive = (dot(direction, face) < 0) == passes;  // else an interpolated normal sent it through the surface
  path->origin = leave_surface(s.point, passes ? -face : face);
  path->direction = direction;
  path->pdf = sample.pdf;
  if (passes && (m.flags & MATERIAL_HAS_INSIDE)) path->media = boundary.inner;
  if (!material_scatters(m)) return;
  path->flags = (path->flags & PATH_SEEN) | PATH_SCATTERED | (material_is_matte(m) ? PATH_DIFFUSE : 0u);
}

// density of the direction `out` that a path came from `in` took, over that of the other way
static inline float scattered_ratio(const PointMaterial m, const Surface s, const Frame frame, const float3 in,
                                    const float3 out, const float pdf) {
  const float other = material_pdf(m, to_local(frame, out), to_local(frame, -in));
  return pdf * light_cosine(s, in) / (other * light_cosine(s, out));
}

// of a camera's path that came from `in` and has scattered; is_first: it met nothing before
static inline void note_scattered(const Launch launch, const PointMaterial m, const Surface s, const Frame frame,
                                  const float3 in, const bool is_first, Path* path) {
  if (!material_scatters(m)) return;
  if (is_first) path->flags |= PATH_SEEN;
  if (material_transmits(m)) path->flags &= ~PATH_SEEN;
  path->density = is_first ? camera_density(launch, s) * path->pdf / light_cosine(s, path->direction)
                           : path->density * scattered_ratio(m, s, frame, in, path->direction, path->pdf);
  path->density = fmin(path->density, MOST_DENSITY);
}

// Paths that carry little end early, the others carry more for them. What is seen through glass that hardly absorbs would
// get dark pixels by that, and its paths are soon out of the glass anyway: they end only where they carry far less.
static inline void roulette(const uint depth, const float u, Path* path) {
  const float largest = max(path->throughput.x, max(path->throughput.y, path->throughput.z));
  if (!(largest > 0)) path->is_alive = false;
  const float enough = path->flags & PATH_SCATTERED ? 1.0f : 0.25f;
  if (depth < 2 || !path->is_alive || largest >= enough) return;
  const float survival = max(largest / enough, 0.05f);
  if (u >= survival) path->is_alive = false;
  path->throughput /= survival;
}
#endif
