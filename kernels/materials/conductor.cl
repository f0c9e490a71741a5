// Rough conductor: f = F D G2 / (4 cos_i cos_o) with the GGX distribution of microfacet normals
//   D(m) = alpha^2 / (pi ((alpha^2 - 1) m_z^2 + 1)^2)  [1/sr]
// (Walter et al. 2007), Smith's height-correlated masking G2 and Schlick's Fresnel term F from the coloured reflectance
// at normal incidence. Sampled by the visible normals (Heitz 2018), so the weight of a sample is F G2 / G1. Light that
// would bounce twice between facets is lost. Below MIRROR_ALPHA a perfect mirror.
#ifndef PVG_MATERIALS_CONDUCTOR_CL
#define PVG_MATERIALS_CONDUCTOR_CL
#include "materials/frame.cl"
#include "materials/material.h"

inline float3 fresnel_schlick(const float3 reflectance, const float cosine) {
  const float x = clamp(1.0f - cosine, 0.0f, 1.0f);
  return reflectance + (1.0f - reflectance) * (x * x * x * x * x);
}

inline float ggx_density(const float3 m, const float alpha) {
  const float a2 = alpha * alpha, k = (a2 - 1.0f) * m.z * m.z + 1.0f;
  return a2 / (M_PI_F * k * k);
}

// Smith's Lambda(w)
inline float ggx_lambda(const float3 w, const float alpha) {
  const float tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  return 0.5f * (sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

// f cos [1/sr]
inline float3 conductor_eval(const float3 reflectance, const float alpha, const float3 wo, const float3 wi) {
  if (wo.z <= 0 || wi.z <= 0 || alpha < MIRROR_ALPHA) return (float3)(0.0f);
  const float3 m = normalize(wo + wi);
  const float G2 = 1.0f / (1.0f + ggx_lambda(wo, alpha) + ggx_lambda(wi, alpha));
  return fresnel_schlick(reflectance, dot(wi, m)) * (ggx_density(m, alpha) * G2 / (4.0f * wo.z));
}

inline float conductor_pdf(const float alpha, const float3 wo, const float3 wi) {
  if (wo.z <= 0 || wi.z <= 0 || alpha < MIRROR_ALPHA) return 0.0f;
  const float3 m = normalize(wo + wi);
  const float G1 = 1.0f / (1.0f + ggx_lambda(wo, alpha));
  return ggx_density(m, alpha) * G1 / (4.0f * wo.z);
}

// a normal of the facets that wo sees
inline float3 ggx_visible_normal(const float3 wo, const float alpha, const float2 u) {
  const float3 v = normalize((float3)(alpha * wo.x, alpha * wo.y, wo.z));
  const float length2 = v.x * v.x + v.y * v.y;
  // seen from above every tangent will do
  const float3 t1 = length2 > 1e-14f ? (float3)(-v.y, v.x, 0) * rsqrt(length2) : (float3)(1, 0, 0);
  const float3 t2 = cross(v, t1);
  const float r = sqrt(u.x), phi = 2.0f * M_PI_F * u.y;
  const float a = r * cos(phi), s = 0.5f * (1.0f + v.z);
  const float b = (1.0f - s) * sqrt(max(0.0f, 1.0f - a * a)) + s * r * sin(phi);
  const float3 n = a * t1 + b * t2 + sqrt(max(0.0f, 1.0f - a * a - b * b)) * v;
  return normalize((float3)(alpha * n.x, alpha * n.y, max(1e-6f, n.z)));
}

inline MaterialSample conductor_sample(const float3 reflectance, const float alpha, const float3 wo, const float2 u) {
  MaterialSample s;
  s.weight = 0.0f;
  s.pdf = 0.0f;
  s.direction = (float3)(-wo.x, -wo.y, wo.z);
  if (wo.z <= 0) return s;
  if (alpha < MIRROR_ALPHA) {
    s.weight = fresnel_schlick(reflectance, wo.z);
    return s;
  }
  const float3 m = ggx_visible_normal(wo, alpha, u);
  const float3 wi = 2.0f * dot(wo, m) * m - wo;
  if (wi.z <= 0) return s;  // would bounce again: lost
  const float lambda_o = ggx_lambda(wo, alpha), lambda_i = ggx_lambda(wi, alpha);
  s.direction = wi;
  s.pdf = conductor_pdf(alpha, wo, wi);
  s.weight = fresnel_schlick(reflectance, dot(wi, m)) * ((1.0f + lambda_o) / (1.0f + lambda_o + lambda_i));
  return s;
}
#endif
