// Diffuse (Lambert) reflection: f = color / pi [1/sr], sampled by the cosine: a uniform disc lifted to the hemisphere
// (Malley's method; concentric map of Shirley and Chiu 1997). Directions point away from the surface, z is the normal.
#ifndef PVG_MATERIALS_DIFFUSE_CL
#define PVG_MATERIALS_DIFFUSE_CL
#include "materials/frame.cl"
#include "materials/material.h"

// f cos [1/sr]
static inline float3 diffuse_eval(const PointMaterial p, const float3 wo, const float3 wi) {
  return wo.z > 0 && wi.z > 0 ? p.color * (wi.z * M_1_PI_F) : (float3)(0.0f);
}

static inline float diffuse_pdf(const PointMaterial p, const float3 wo, const float3 wi) {
  return wo.z > 0 && wi.z > 0 ? wi.z * M_1_PI_F : 0.0f;
}

// sine and cosine within pi/4, by Taylor's series: all that a disc takes. Those of the language also serve large angles,
// which takes longer
static inline float2 small_sin_cos(const float x) {
  const float x2 = x * x;
  return (float2)(x * (1 - x2 * (1 / 6.0f - x2 * (1 / 120.0f - x2 * (1 / 5040.0f - x2 * (1 / 362880.0f))))),
                  1 - x2 * (1 / 2.0f - x2 * (1 / 24.0f - x2 * (1 / 720.0f - x2 * (1 / 40320.0f)))));
}

// a square onto a disc, concentric (Shirley and Chiu 1997)
static inline float2 uniform_disc(const float2 u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return (float2)(0.0f);
  const bool is_wide = fabs(a) > fabs(b);
  const float r = is_wide ? a : b;
  const float2 turn = r * small_sin_cos(M_PI_4_F * (is_wide ? b / a : a / b));
  return is_wide ? turn.yx : turn;
}

static inline MaterialSample diffuse_sample(const PointMaterial p, const float3 wo, const float2 u,
                                            const float choice) {
  const float2 disc = uniform_disc(u);
  // never exactly in the surface, so that the density stays positive
  const float z = sqrt(max(1e-8f, 1.0f - dot(disc, disc)));
  MaterialSample s;
  s.direction = (float3)(disc.x, disc.y, z);
  s.pdf = diffuse_pdf(p, wo, s.direction);
  s.weight = wo.z > 0 ? p.color : (float3)(0.0f);
  return s;
}
#endif
