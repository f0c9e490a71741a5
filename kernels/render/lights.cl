// Samples of the rectangular lights: a light by its share of the power, a point on it uniformly.
//   density over directions = probability / area * distance^2 / cos  [1/sr]
#ifndef PVG_RENDER_LIGHTS_CL
#define PVG_RENDER_LIGHTS_CL
#include "render/path.h"

typedef struct {
  uint index;
  float3 point;  // [m]
} LightSample;

inline LightSample sample_light(global const Light* lights, const uint n_lights, const float2 u) {
  uint i = 0;
  while (i + 1 < n_lights && u.x >= lights[i].cumulative) ++i;
  global const Light* light = lights + i;
  // what is left of the number that chose the light is again uniform
  const float a = clamp((u.x - (light->cumulative - light->probability)) / light->probability, 0.0f, 0x1.fffffep-1f);
  LightSample s;
  s.index = i;
  s.point = vload3(0, light->corner) + a * vload3(0, light->edge_u) + u.y * vload3(0, light->edge_v);
  return s;
}

// to_light: from the lit point to the point on the light [m]; 0: the light shines the other way
inline float light_pdf(global const Light* light, const float3 to_light) {
  const float distance2 = dot(to_light, to_light);
  const float cosine = -dot(vload3(0, light->normal), to_light) * rsqrt(distance2);
  return cosine > 0 ? light->probability * distance2 / (light->area * cosine) : 0.0f;
}

// power heuristic of multiple importance sampling (Veach 1997)
inline float mis_weight(const float pdf, const float other) {
  const float a = pdf * pdf, b = other * other;
  return a > 0 ? a / (a + b) : 0.0f;
}
#endif
