// Rough conductor: f = F D G2 / (4 cos_i cos_o) with GGX microfacets (microfacet.cl), Smith's height-correlated masking
// G2. The Fresnel term from the coloured reflectance F_0 at normal incidence: Schlick's with a dip before the edge,
//   F(c) = F_0 + (1 - F_0) (1 - c)^5 - a c (1 - c)^6
// (Lazanyi and Szirmay-Kalos 2005), a = own_color, 0 or of a measured metal (host/model/metals.cpp). Sampled by the visible
// normals, so the weight of a sample is F G2 / G1. Light that would bounce twice between facets is lost. Below MIRROR_ALPHA a
// perfect mirror.
#ifndef PVG_MATERIALS_CONDUCTOR_CL
#define PVG_MATERIALS_CONDUCTOR_CL
#include "materials/material.h"
#include "materials/microfacet.cl"

static inline float3 fresnel_schlick(const float3 reflectance, const float cosine) {
  const float x = clamp(1.0f - cosine, 0.0f, 1.0f);
  return reflectance + (1.0f - reflectance) * (x * x * x * x * x);
}

// dip: a
static inline float3 fresnel_conductor(const float3 reflectance, const float3 dip, const float cosine) {
  const float x = clamp(1.0f - cosine, 0.0f, 1.0f), x3 = x * x * x;
  return fresnel_schlick(reflectance, cosine) - dip * ((1.0f - x) * x3 * x3);
}

// f cos [1/sr]
static inline float3 conductor_eval(const PointMaterial p, const float3 wo, const float3 wi) {
  const float alpha = p.alpha;
  if (wo.z <= 0 || wi.z <= 0 || alpha < MIRROR_ALPHA) return (float3)(0.0f);
  const float3 m = normalize(wo + wi);
  const float G2 = 1.0f / (1.0f + ggx_lambda(wo, alpha) + ggx_lambda(wi, alpha));
  return fresnel_conductor(p.color, p.own_color, dot(wi, m)) * (ggx_density(m, alpha) * G2 / (4.0f * wo.z));
}

static inline float conductor_pdf(const PointMaterial p, const float3 wo, const float3 wi) {
  const float alpha = p.alpha;
  if (wo.z <= 0 || wi.z <= 0 || alpha < MIRROR_ALPHA) return 0.0f;
  const float3 m = normalize(wo + wi);
  const float G1 = 1.0f / (1.0f + ggx_lambda(wo, alpha));
  return ggx_density(m, alpha) * G1 / (4.0f * wo.z);
}

static inline MaterialSample conductor_sample(const PointMaterial p, const float3 wo, const float2 u,
                                              const float choice) {
  const float alpha = p.alpha;
  MaterialSample s;
  s.weight = 0.0f;
  s.pdf = 0.0f;
  s.direction = (float3)(-wo.x, -wo.y, wo.z);
  if (wo.z <= 0) return s;
  if (alpha < MIRROR_ALPHA) {
    s.weight = fresnel_conductor(p.color, p.own_color, wo.z);
    return s;
  }
  const float3 m = ggx_visible_normal(wo, alpha, u);
  const float3 wi = 2.0f * dot(wo, m) * m - wo;
  if (wi.z <= 0) return s;  // would bounce again: lost
  const float lambda_o = ggx_lambda(wo, alpha), lambda_i = ggx_lambda(wi, alpha);
  s.direction = wi;
  s.pdf = conductor_pdf(p, wo, wi);
  s.weight = fresnel_conductor(p.color, p.own_color, dot(wi, m)) * ((1.0f + lambda_o) / (1.0f + lambda_o + lambda_i));
  return s;
}
#endif
