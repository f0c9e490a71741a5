// Stage 3: what happens where one path hit. Adds what the surface itself shines, sends one shadow ray toward a light, and
// continues the path by a sample of the material.
//   light that a path meets: weighted against the light samples of the last scattering surface (power heuristic)
//   clear glass between a matte surface and a light: shadow rays pass straight through, attenuated (transmittance.cl), and
//     the refracted paths to that light are left out, so that no light is counted twice. Other surfaces keep the
//     refracted paths and their shadow rays stop at glass. Launch::transparent_shadows = 0: glass stops all shadow rays
//     and every refracted path counts
//   light that mirror-like surfaces throw onto what the camera sees, with --caustics: found by these paths and by those of
//     lamps, weighted against each other (light_tracing.cl)
//   shadow receiver: its texture, dimmed by the shadows of inserted objects (receiver.cl)
#ifndef PVG_RENDER_SHADE_PATH_CL
#define PVG_RENDER_SHADE_PATH_CL
#include "render/interact.cl"
#include "render/met_surface.cl"
#include "render/noted.cl"
#include "render/receiver.cl"
#include "render/slots.cl"

// glass or a surface that scatters: light sample, then the path goes on. triangle: index into those of all meshes
static inline void meet_surface(const Launch launch, const Shading scene, global const Instance* instance,
                                const uint triangle, const Material m, const float3 color, const Surface s,
                                const Chance chance, const uint depth, Path* path, ShadowRay* shadow) {
  const MetSurface met = met_surface(scene, instance, triangle, m, color, s, path->direction, path->media);
  if (met.boundary.is_hidden) {
    pass_hidden(met.boundary, s, met.face, path);
    return;
  }
  if (met.material.kind == MATERIAL_DIELECTRIC) {
    pass_glass(met.material, met.boundary, s, met.face, met.normal, chance.material_choice, path);
    return;
  }
  const Frame frame = make_frame(met.normal);
  const float3 in = path->direction, wo = to_local(frame, -in);
  light_surface(launch, scene, met.material, s, met.face, frame, wo, chance, path, shadow);
  scatter(met.material, met.boundary, s, met.face, frame, wo, chance, path);
  if (launch.n_light_paths > 0) note_scattered(launch, met.material, s, frame, in, depth == 0, path);
}

// hit: t, u, v, triangle
// a function of its own: PoCL compiles what stands in a kernel three times
OUT_OF_LINE void meet(const Launch launch, const Shading scene, const Chance chance, const uint depth,
                      const float4 hit, const uint hit_instance, const Notes notes, Path* path, ShadowRay* shadow) {
  global const Instance* instance = scene.instances + hit_instance;
  const uint triangle = as_uint(hit.w);
  const Surface s = surface_with_uvs(scene, hit_instance, triangle, hit.y, hit.z);
  const float3 carried = path->throughput;
  path->throughput *= media_transmission(path->media, scene.materials, hit.x + ray_offset(s.point));
  if (instance->visual == 0) {
    if (notes.is_wanted) write_note(notes, note_light(s, path->direction), carried);
    meet_light(launch, scene, scene.lights + instance->light, s, hit.x, path);
    return;
  }
  const Material m = scene.materials[instance->material];
  if (m.flags & MATERIAL_EMITS) meet_shining(launch, scene, instance, m, triangle, s, hit.x, path);
  const float3 color = surface_color(scene, instance, m, s, triangle, hit.y, hit.z);
  if (notes.is_wanted) write_note(notes, note_surface(scene, m, color, s, path->direction), carried);
  if (m.kind == MATERIAL_SHADOW_RECEIVER) {
    meet_receiver(launch, scene, m, color, s, chance, path, shadow);
  } else if (m.kind == MATERIAL_EMISSIVE || depth >= launch.max_depth) {
    path->is_alive = false;
  } else {
    meet_surface(launch, scene, instance, triangle, m, color, s, chance, depth, path, shadow);
    roulette(depth, chance.roulette, path);
  }
}

// place: in the queue.  shadow_origin: w: kind;  shadow_direction: to the light [m];  shadow_light: w: weight;
// feature_color, feature_normal: with notes_features what guides a denoiser (noted.cl), as long as no surface has
// scattered the path
static inline void shade_path(const Launch launch, const Shading scene, const uint depth, const uint notes_features,
                              const uint place, const Slots slots) {
  const uint slot = slots.queue[place];
  const float4 hit = slots.hit[slot];
  Path path = load_path(slot, slots.origin, slots.direction, slots.throughput);
  ShadowRay shadow = {0.0f, 0.0f, 0.0f, 0.0f, SHADOW_NONE};
  if (launch.n_light_paths > 0) path.density = slots.radiance[slot].w;
  const bool is_noted = notes_features && !(path.flags & PATH_SCATTERED);
  const Notes notes = {is_noted, slot, is_noted && depth > 0 ? slots.feature_color[slot].w : 1.0f, slots.feature_color,
                       slots.feature_normal};
  if (as_uint(hit.w) == NO_TRIANGLE) {
    if (notes.is_wanted)
      write_note(notes, note_environment(environment_radiance(launch, scene.environment, path.direction)),
                 path.throughput);
    meet_environment(launch, scene, &path);
  } else {
    meet(launch, scene, draw_chance(slots.stream[slot], depth), depth, hit, slots.hit_instance[slot], notes, &path,
         &shadow);
    weigh_note(notes, path.likelihood);
  }
  if (any(path.radiance != 0.0f)) slots.radiance[slot] += (float4)(path.radiance, 0);
  if (launch.n_light_paths > 0) slots.radiance[slot].w = path.density;
  slots.alive[place] = path.is_alive ? 1u : 0u;
  // also of paths that end, which no one reads: cheaper than a branch that is hard to foresee
  slots.origin[slot] = (float4)(path.origin, path.pdf);
  slots.direction[slot] = (float4)(path.direction, as_float(path.media));
  slots.throughput[slot] = (float4)(path.throughput, as_float(path.flags));
  slots.shadow_origin[slot] = (float4)(shadow.origin, as_float(shadow.kind));
  if (shadow.kind == SHADOW_NONE) return;
  slots.shadow_direction[slot] = (float4)(shadow.direction, 0);
  slots.shadow_light[slot] = (float4)(shadow.light, shadow.weight);
}
#endif
