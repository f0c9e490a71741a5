// The glasses that a path is inside of: a stack of up to four material numbers, one byte each, the innermost lowest.
// Glass materials stand first in the list, so that index + 1 fits a byte; 0 is air.
#ifndef PVG_RENDER_MEDIA_CL
#define PVG_RENDER_MEDIA_CL
#include "materials/material.h"

inline uint media_enter(const uint media, const uint material) { return (media << 8) | (material + 1); }

// takes the innermost entry of that material away
inline uint media_leave(const uint media, const uint material) {
  for (uint i = 0; i < 4; ++i) {
    if (((media >> (8 * i)) & 0xffu) != material + 1) continue;
    const uint below = i == 0 ? 0u : media & ((1u << (8 * i)) - 1u);
    const uint above = i == 3 ? 0u : (media >> (8 * i + 8)) << (8 * i);
    return above | below;
  }
  return media;
}

inline float media_ior(const uint media, global const Material* materials) {
  return media & 0xffu ? materials[(media & 0xffu) - 1].ior : 1.0f;
}

inline float3 media_transmission(const uint media, global const Material* materials, const float distance) {
  if (!(media & 0xffu)) return (float3)(1.0f);
  return exp(-distance * vload3(0, materials[(media & 0xffu) - 1].absorption));
}
#endif
