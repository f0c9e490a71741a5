// What guides a denoiser: colour and normal of the first surface that scatters, met by the same paths that bring the
// light. So they are spread over the pixel and its exposure as the light is, and are seen through clear glass and in
// mirrors.
// At clear glass a path reflects or refracts by chance, and what it notes behind that would be as noisy as its light: a
// filter takes such noise for a texture and leaves it. So a note counts less where the path did what is less likely.
#ifndef PVG_RENDER_NOTED_CL
#define PVG_RENDER_NOTED_CL
#include "materials/list.cl"
#include "render/lights.cl"

typedef struct {
  float3 color;   // in [0, 1]
  float3 normal;  // unit, world, toward the path, or 0
} Noted;

// Where the notes of a path go: each is written at once, since to hold it would take registers of all that follows.
typedef struct {
  bool is_wanted;
  uint slot;
  float weight;                   // of the path so far, 1 at the camera
  global float4 *color, *normal;  // [n_slots], w of the first: the weight; of the second: unused
} Notes;

// weight of a path that did nothing but what is unlikely: not 0, so that a pixel of such paths alone has their mean
#define LEAST_NOTE 1e-4f

// carried: the path's throughput up to here
static inline void write_note(const Notes notes, const Noted noted, const float3 carried) {
  notes.color[notes.slot] = (float4)(noted.color * clamp(carried, 0.0f, 1.0f), notes.weight);
  notes.normal[notes.slot] = (float4)(noted.normal, 0);
}

// what the path notes from now on;  likelihood: as in Path
static inline void weigh_note(const Notes notes, const float likelihood) {
  if (notes.is_wanted && likelihood < 1.0f)
    notes.color[notes.slot].w = max(notes.weight * likelihood, LEAST_NOTE);
}

// the share of white light that the surface scatters back or shines, at most 1;  color: of the surface, its textures
// looked up
static inline float3 scattered_color(const Shading scene, const Material m, const float3 color, const Surface s) {
  float3 scattered = m.kind == MATERIAL_EMISSIVE ? (float3)(0.0f) : color;
  if (m.flags & MATERIAL_EMITS) scattered += emitted(scene, m, uv_for(s, m.flags, emission_bit(m)));
  return clamp(scattered, 0.0f, 1.0f);
}

// where a path leaves the scene; radiance: from there
static inline Noted note_environment(const float3 radiance) {
  const Noted noted = {clamp(radiance, 0.0f, 1.0f), (float3)(0.0f)};
  return noted;
}

// a rectangle or sphere that shines
static inline Noted note_light(const Surface s, const float3 direction) {
  const Noted noted = {(float3)(1.0f), dot(s.shading, direction) < 0 ? s.shading : -s.shading};
  return noted;
}

// what is clear or a mirror is overwritten by what is seen in it, where the path does not end first
static inline Noted note_surface(const Shading scene, const Material m, const float3 color, const Surface s,
                                 const float3 direction) {
  Noted noted = note_light(s, direction);
  noted.color = material_scatters(point_material(m, 1.0f)) ? scattered_color(scene, m, color, s) : (float3)(0.0f);
  return noted;
}
#endif
