// Clear dielectric, smooth: reflects the Fresnel share R of unpolarised light, refracts the rest by Snell's law. One of
// the two is chosen with probability R, so the weight is 1. What is carried is radiance / n^2, which refraction leaves
// unchanged. Absorption along the way inside (Beer and Lambert) is applied where the segment ends.
// A thin sheet has no inside: with all reflections between its faces it reflects 2 R / (1 + R) and lets the rest
// through, tinted and straight on.
#ifndef PVG_MATERIALS_DIELECTRIC_CL
#define PVG_MATERIALS_DIELECTRIC_CL
#include "materials/frame.cl"
#include "materials/material.h"

// share that is reflected; cosine: of the incident direction, >= 0; eta: index behind / index in front of the interface
static inline float fresnel_dielectric(const float cosine, const float eta) {
  const float sin2 = (1.0f - cosine * cosine) / (eta * eta);
  if (sin2 >= 1.0f) return 1.0f;  // total reflection
  const float cos_t = sqrt(1.0f - sin2);
  const float s = (cosine - eta * cos_t) / (cosine + eta * cos_t);
  const float p = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  return 0.5f * (s * s + p * p);
}

// of both faces of a thin sheet together
static inline float fresnel_sheet(const float cosine, const float eta) {
  const float R = fresnel_dielectric(cosine, eta);
  return 2.0f * R / (1.0f + R);
}

// the chance that dielectric_sample() reflects
static inline float dielectric_reflectance(const PointMaterial p, const float3 wo) {
  return p.flags & MATERIAL_THIN ? fresnel_sheet(wo.z, p.eta) : fresnel_dielectric(wo.z, p.eta);
}

static inline MaterialSample sheet_sample(const float3 tint, const float3 wo, const bool reflects) {
  MaterialSample s;
  s.pdf = 0.0f;
  s.weight = reflects ? (float3)(1.0f) : tint;
  s.direction = reflects ? (float3)(-wo.x, -wo.y, wo.z) : -wo;
  return s;
}

// no light sample finds its two directions
static inline float3 dielectric_eval(const PointMaterial p, const float3 wo, const float3 wi) { return (float3)(0.0f); }
static inline float dielectric_pdf(const PointMaterial p, const float3 wo, const float3 wi) { return 0.0f; }

// z: the normal on the side of wo. direction.z < 0: refracted, and tinted
static inline MaterialSample dielectric_sample(const PointMaterial p, const float3 wo, const float2 u,
                                               const float choice) {
  const bool reflects = choice < dielectric_reflectance(p, wo);
  if (p.flags & MATERIAL_THIN) return sheet_sample(p.color, wo, reflects);
  const float eta = p.eta;
  MaterialSample s;
  s.weight = 1.0f;
  s.pdf = 0.0f;
  if (reflects) {
    s.direction = (float3)(-wo.x, -wo.y, wo.z);
    return s;
  }
  s.weight = p.color;
  const float sin2 = (wo.x * wo.x + wo.y * wo.y) / (eta * eta);
  s.direction = (float3)(-wo.x / eta, -wo.y / eta, -sqrt(max(0.0f, 1.0f - sin2)));
  return s;
}
#endif
