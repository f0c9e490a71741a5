// A shadow receiver, a captured surface that keeps its look: C = C_tex (1 - lambda_s (1 - V)), and the path ends there.
// V is the share of the light that no inserted object hides, by one shadow ray:
//   the ambient share  toward a direction by the cosine: light that comes evenly from all around, as walls send it
//   lamps alone        toward a sample of them, drawn by power
//   an environment     toward one of several samples, in proportion to the irradiance that each brings (resampled
//                      importance sampling, Talbot 2005), so that neither a dim room beside a lamp nor light from below
//                      thins a lamp's shadow. Half of them are samples of all lights, half are directions of the
//                      environment by the cosine, weighted against each other by the balance heuristic (Veach 1997)
#ifndef PVG_RENDER_RECEIVER_CL
#define PVG_RENDER_RECEIVER_CL
#include "materials/diffuse.cl"
#include "render/interact.cl"

#define RECEIVER_PAIRS 4

// what a sample brings to a surface [W/m^2, mean of three colours]; 0: it cannot shine here
static inline float candidate_irradiance(const LightSample s, const float3 normal) {
  const float distance = length(s.to_light), cosine = dot(normal, s.to_light) / distance;
  if (!(cosine > 0) || !(s.pdf > 0)) return 0.0f;
  const bool is_environment = distance > 0.5f * FAR_AWAY;
  const float pdf = s.pdf + (is_environment ? cosine * M_1_PI_F : 0.0f);
  return cosine * (s.radiance.x + s.radiance.y + s.radiance.z) / (3 * RECEIVER_PAIRS * pdf);
}

// [m] as far as the environment, by the cosine
static inline float3 even_direction(const float3 normal, const float2 u) {
  const float2 disc = uniform_disc(u);
  return FAR_AWAY * to_world(make_frame(normal), (float3)(disc, sqrt(max(1e-8f, 1.0f - dot(disc, disc)))));
}

// such a direction of the environment, with the density that a light sample would have had
static inline LightSample sample_sky(const Launch launch, const Shading scene, const float3 normal, const float2 u) {
  LightSample s;
  s.to_light = even_direction(normal, u);
  const float3 d = unit(s.to_light);
  s.radiance = environment_radiance(launch, scene.environment, d);
  s.pdf = scene.lights[launch.environment_light].probability * environment_pdf(launch, scene.cells, d);
  return s;
}

// one light sample for V; pdf 0: nothing shines here
static inline LightSample sample_irradiance(const Launch launch, const Shading scene, const float3 origin,
                                            const float3 normal, const Chance chance) {
  LightSample chosen;
  chosen.pdf = 0.0f;
  float total = 0.0f, rest = chance.material_choice;
  for (int k = 0; k < 2 * RECEIVER_PAIRS; ++k) {
    // lights in strata, points by a lattice of low discrepancy (Roberts 2018)
    const float2 point = chance.light_point + (float)k * (float2)(0.75487767f, 0.56984029f);
    const float2 choice =
        (float2)(chance.light_choice.x + (float)k / (2 * RECEIVER_PAIRS), chance.light_choice.y);
    const LightSample s = k & 1 ? sample_sky(launch, scene, normal, point - floor(point))
                                : sample_light(launch, scene, origin, choice - floor(choice), point - floor(point));
    const float irradiance = candidate_irradiance(s, normal);
    if (!(irradiance > 0)) continue;
    total += irradiance;
    const float share = irradiance / total;  // of the first: 1
    const bool is_taken = rest < share;
    if (is_taken) chosen = s;
    // what is left of the number is again uniform
    rest = clamp(is_taken ? rest / share : (rest - share) / (1.0f - share), 0.0f, 0x1.fffffep-1f);
  }
  return chosen;
}

// toward what V is measured [m]; zero: nothing shines here
static inline float3 light_of_receiver(const Launch launch, const Shading scene, const float ambient,
                                       const float3 origin, const float3 normal, const Chance chance) {
  if (chance.roulette < ambient) return even_direction(normal, chance.material_point);
  if (launch.n_lights == 0) return 0.0f;
  const LightSample sample = launch.environment_light < 0
                                 ? sample_light(launch, scene, origin, chance.light_choice, chance.light_point)
                                 : sample_irradiance(launch, scene, origin, normal, chance);
  return sample.pdf > 0 && dot(normal, sample.to_light) > 0 ? sample.to_light : 0.0f;
}

static inline void meet_receiver(const Launch launch, const Shading scene, const Material m, const float3 color,
                                 const Surface s, const Chance chance, Path* path, ShadowRay* shadow) {
  path->is_alive = false;
  const float3 shown = path->throughput * color * launch.receiver_scale;
  path->radiance += shown * (1.0f - m.shadow_strength);
  const float3 shaded = shown * m.shadow_strength;
  if (m.shadow_strength == 0) return;
  const float3 normal = dot(s.face, path->direction) < 0 ? s.face : -s.face;
  const float3 origin = leave_surface(s.point, normal);
  const float3 to_light = light_of_receiver(launch, scene, m.own_number, origin, normal, chance);
  if (dot(to_light, to_light) == 0) {  // a light that cannot shine here casts no shadow here
    path->radiance += shaded;
    return;
  }
  shadow->kind = SHADOW_RECEIVER;
  shadow->origin = origin;
  shadow->direction = to_light;
  shadow->light = shaded;
  shadow->weight = 1.0f;
}
#endif
