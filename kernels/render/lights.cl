// Samples of the lights: one of all by its share of the power (alias table, Vose 1991: the cost does not grow with
// their number), then a point on it. Densities over directions [1/sr], the choice included:
//   rectangle, triangle of a shining mesh   probability / area * distance^2 / cos
//   sphere                                  probability / (2 pi (1 - cos_max)), evenly in the cone that it fills
//   environment                             probability * that of environment.cl
#ifndef PVG_RENDER_LIGHTS_CL
#define PVG_RENDER_LIGHTS_CL
#include "materials/frame.cl"
#include "materials/list.h"
#include "materials/texture.cl"
#include "render/cutout.cl"
#include "render/environment.cl"
#include "render/surface.cl"

// what shading reads of the scene
typedef struct {
  global const Instance* instances;
  global const Material* materials;
  global const TextureInfo* textures;
  global const uchar4* texels;
  constant float* decode;
  global const uint* triangles;
  global const Vertex* vertices;
  global const float* colors;
  global const float* second_uvs;
  global const Light* lights;
  global const float* environment;
  global const EnvironmentCell* cells;
  global const float4* targets;  // of light paths, see light_tracing.cl
} Shading;

typedef struct {
  float3 to_light;  // from the lit point [m]
  float3 radiance;
  float pdf;  // 0: nothing shines here
} LightSample;

// beyond everything, where the environment is [m]
#define FAR_AWAY 1e5f
// the sphere that rays hit is made of triangles: shadow rays end a little outside
#define SPHERE_SHELL 1.005f

// the surface at a hit with all its texture coordinates
static inline Surface surface_with_uvs(const Shading scene, const uint instance, const uint triangle, const float u,
                                       const float v) {
  global const Instance* shown = scene.instances + instance;
  Surface s = surface_at(shown, scene.triangles, scene.vertices, triangle, u, v);
  if (shown->flags & INSTANCE_SECOND_UVS)
    s.second_uv = second_uv_at(shown, scene.triangles, scene.second_uvs, triangle, u, v);
  return s;
}

// SECOND_UVS_... of the texture that shines
static inline uint emission_bit(const Material m) {
  return m.kind == MATERIAL_EMISSIVE ? SECOND_UVS_COLOR : SECOND_UVS_EMISSION;
}
static inline float3 emitted(const Shading scene, const Material m, const float2 uv) {
  const float3 emission = vload3(0, m.emission);
  const int texture = m.kind == MATERIAL_EMISSIVE ? m.texture : m.emission_texture;
  return texture < 0 ? emission
                     : emission * texture_color(scene.textures[texture], scene.texels, scene.decode, uv);
}

static inline Cutouts cutouts_of(const Shading scene) {
  const Cutouts c = {scene.instances, scene.materials, scene.textures,  scene.texels,
                     scene.triangles, scene.vertices,  scene.second_uvs};
  return c;
}

// corners of a mesh's triangle in the world
static inline void world_triangle(const Shading scene, global const Instance* instance, const uint triangle,
                                  float3 p[3]) {
  const uint3 corner = vload3(triangle, scene.triangles);
  p[0] = affine_point(instance->to_world, vload3(0, scene.vertices[corner.x].point));
  p[1] = affine_point(instance->to_world, vload3(0, scene.vertices[corner.y].point));
  p[2] = affine_point(instance->to_world, vload3(0, scene.vertices[corner.z].point));
}

static inline float area_pdf(const float probability, const float area, const float cosine, const float distance2) {
  return cosine > 0 && area > 0 ? probability * distance2 / (area * cosine) : 0.0f;
}

// 1 - cosine of half the angle that a sphere fills, seen from squared distance d2; exact where it is small
static inline float cone_height(const float radius, const float d2) {
  const float sin2 = radius * radius / d2;
  return sin2 / (1.0f + sqrt(max(0.0f, 1.0f - sin2)));
}

static inline float sphere_pdf(global const Light* light, const float3 origin) {
  const float3 d = vload3(0, light->corner) - origin;
  const float d2 = dot(d, d);
  return d2 > light->radius * light->radius
             ? light->probability / (2.0f * M_PI_F * cone_height(light->radius, d2))
             : 0.0f;  // inside there is no light
}

// a spot's share of the radiance in a direction away from it (KHR_lights_punctual); 1 of what is none
static inline float spot_share(global const Light* light, const float3 away) {
  const float x = clamp((dot(vload3(0, light->edge_u), away) - light->edge_v[0]) * light->edge_v[1], 0.0f, 1.0f);
  return x * x;
}

static inline LightSample sample_sphere(global const Light* light, const float3 origin, const float2 u) {
  LightSample s;
  const float3 center = vload3(0, light->corner) - origin;
  const float d2 = dot(center, center), radius = light->radius;
  s.pdf = sphere_pdf(light, origin);
  s.radiance = vload3(0, light->radiance);
  // h = 1 - cosine and r = sine of the angle from the center; differences of nearly equal numbers would lose a small sphere
  const float h = u.x * cone_height(radius, d2), r2 = h * (2.0f - h), r = sqrt(r2), phi = 2.0f * M_PI_F * u.y;
  const float3 direction = to_world(make_frame(center * rsqrt(d2)), (float3)(r * cos(phi), r * sin(phi), 1.0f - h));
  s.radiance *= spot_share(light, -direction);
  // up to the shell around the triangles
  const float shell = SPHERE_SHELL * radius, half_chord2 = shell * shell - d2 * r2;
  s.to_light = direction * max(0.0f, sqrt(d2) * (1.0f - h) - sqrt(max(0.0f, half_chord2)));
  // so close that the shell is around the point: nothing can be between
  if (dot(s.to_light, s.to_light) == 0) s.to_light = direction * (1e-3f * radius);
  return s;
}

static inline LightSample sample_triangle(const Shading scene, global const Light* light, const float3 origin,
                                          const float2 u) {
  LightSample s;
  global const Instance* instance = scene.instances + light->instance;
  float3 p[3];
  world_triangle(scene, instance, light->triangle, p);
  const float root = sqrt(u.x), b = root * u.y, a = 1.0f - root;  // evenly over the triangle; weight of p[1] is the rest
  s.to_light = a * p[0] + (1.0f - a - b) * p[1] + b * p[2] - origin;
  const float3 normal = cross(p[1] - p[0], p[2] - p[0]);
  const float twice_area = length(normal), d2 = dot(s.to_light, s.to_light);
  const float cosine = twice_area > 0 ? fabs(dot(normal, s.to_light)) * rsqrt(d2) / twice_area : 0.0f;
  s.pdf = area_pdf(light->probability, 0.5f * twice_area, cosine, d2);
  const Material m = scene.materials[instance->material];
  const Cutouts cutouts = cutouts_of(scene);
  const float c = 1.0f - a - b;  // weight of p[1]
  s.radiance = emitted(scene, m, texture_uv(cutouts, instance, m.flags, emission_bit(m), light->triangle, c, b));
  if (instance->flags & INSTANCE_CUTOUT)
    s.radiance *= 1.0f - opening(cutouts, light->instance, light->triangle, c, b);
  return s;
}

static inline float rectangle_pdf(global const Light* light, const float3 to_light) {
  const float d2 = dot(to_light, to_light);
  return area_pdf(light->probability, light->area, -dot(vload3(0, light->normal), to_light) * rsqrt(d2), d2);
}

// one of all by its share of the power; rest: what is left of the numbers, again uniform
static inline global const Light* choose_light(const Launch launch, const Shading scene, const float2 choice,
                                               float* rest) {
  const uint i = min((uint)(choice.x * (float)launch.n_lights), launch.n_lights - 1);
  const float keep = scene.lights[i].keep;
  const bool keeps = choice.y < keep;
  *rest = clamp(keeps ? choice.y / keep : (choice.y - keep) / (1.0f - keep), 0.0f, 0x1.fffffep-1f);
  return scene.lights + (keeps ? i : scene.lights[i].other);
}

// choice: of the light and by its alias; u: of the point
static inline LightSample sample_light(const Launch launch, const Shading scene, const float3 origin,
                                       const float2 choice, const float2 u) {
  float rest;
  global const Light* light = choose_light(launch, scene, choice, &rest);
  if (light->kind == LIGHT_SPHERE) return sample_sphere(light, origin, u);
  if (light->kind == LIGHT_TRIANGLE) return sample_triangle(scene, light, origin, u);
  LightSample s;
  if (light->kind == LIGHT_ENVIRONMENT) {
    const float3 d = environment_sample(launch, scene.cells, u, rest);
    s.to_light = FAR_AWAY * d;
    s.radiance = environment_radiance(launch, scene.environment, d);
    s.pdf = light->probability * environment_pdf(launch, scene.cells, d);
    return s;
  }
  s.to_light = vload3(0, light->corner) + u.x * vload3(0, light->edge_u) + u.y * vload3(0, light->edge_v) - origin;
  s.radiance = vload3(0, light->radiance);
  s.pdf = rectangle_pdf(light, s.to_light);
  return s;
}

// power heuristic of multiple importance sampling (Veach 1997)
static inline float mis_weight(const float pdf, const float other) {
  const float a = pdf * pdf, b = other * other;
  return a > 0 ? a / (a + b) : 0.0f;
}
#endif
