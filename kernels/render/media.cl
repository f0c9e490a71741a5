// The solids that a path is inside of: a list of up to four material numbers, one byte each, the last one entered
// lowest. Materials with an inside stand first among all, so that index + 1 fits a byte; 0 is air. Where solids overlap
// the one of the highest priority is there, of equal ones the last one entered (after Schmidt and Budge 2002): water
// whose surface lies a little inside the glass of its beaker leaves no gap of air.
#ifndef PVG_RENDER_MEDIA_CL
#define PVG_RENDER_MEDIA_CL
#include "materials/material.h"

static inline uint media_enter(const uint media, const uint material) { return (media << 8) | (material + 1); }

static inline bool media_holds(const uint media, const uint material) {
  for (uint i = 0; i < 4; ++i)
    if (((media >> (8 * i)) & 0xffu) == material + 1) return true;
  return false;
}

// takes the last entry of that material away
static inline uint media_leave(const uint media, const uint material) {
  for (uint i = 0; i < 4; ++i) {
    if (((media >> (8 * i)) & 0xffu) != material + 1) continue;
    const uint below = i == 0 ? 0u : media & ((1u << (8 * i)) - 1u);
    const uint above = i == 3 ? 0u : (media >> (8 * i + 8)) << (8 * i);
    return above | below;
  }
  return media;
}

// 1 + the material that is there, 0: air
static inline uint media_current(const uint media, global const Material* materials) {
  uint current = 0, priority = 0;
  for (uint i = 0; i < 4; ++i) {
    const uint entry = (media >> (8 * i)) & 0xffu;
    if (entry == 0 || (current != 0 && materials[entry - 1].priority <= priority)) continue;
    current = entry;
    priority = materials[entry - 1].priority;
  }
  return current;
}

static inline float medium_ior(const uint current, global const Material* materials) {
  return current ? materials[current - 1].ior : 1.0f;
}

static inline float3 media_transmission(const uint media, global const Material* materials, const float distance) {
  if (media == 0) return (float3)(1.0f);
  const uint current = media_current(media, materials);
  return exp(-distance * vload3(0, materials[current - 1].absorption));
}

// The surface of a solid, from where a path meets it.
typedef struct {
  float eta;       // index behind / in front
  uint inner;      // list behind the surface
  bool is_hidden;  // another solid is on both sides: nothing happens here
} Boundary;

// A path that leaves what it never entered started inside.
static inline Boundary boundary_of(const uint media, const uint material, global const Material* materials,
                                   const bool enters) {
  const uint outer = enters || media_holds(media, material) ? media : media_enter(media, material);
  Boundary b;
  b.inner = enters ? media_enter(outer, material) : media_leave(outer, material);
  const uint front = media_current(outer, materials), back = media_current(b.inner, materials);
  b.eta = medium_ior(back, materials) / medium_ior(front, materials);
  b.is_hidden = front == back;
  return b;
}
#endif
