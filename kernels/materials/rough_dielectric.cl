// Rough dielectric, such as frosted glass: every GGX microfacet reflects the share F and refracts the rest (Walter et
// al. 2007). For radiance / n^2, which refraction leaves unchanged, with eta = index behind / in front:
//   reflected  f cos = F D G2 / (4 cos_o)
//   refracted  f cos = (1 - F) D G1(o) G1(i) (wo . m) / cos_o  *  eta^2 |wi . m| / (wo . m + eta wi . m)^2
// Sampled by the visible normals, then one of the two with probability F, so the weight is G2 / G1. Light that would
// meet a second facet is lost. color tints what passes.
#ifndef PVG_MATERIALS_ROUGH_DIELECTRIC_CL
#define PVG_MATERIALS_ROUGH_DIELECTRIC_CL
#include "materials/dielectric.cl"
#include "materials/microfacet.cl"

// refracted part; also that of metallic_roughness.cl, which has another F
static inline float ggx_refraction(const float alpha, const float eta, const float3 wo, const float3 wi,
                                   const float3 m) {
  if (dot(wo, m) <= 0 || dot(wi, m) >= 0) return 0.0f;
  return ggx_visible_density(wo, m, alpha) * refraction_jacobian(wo, wi, m, eta) / (1.0f + ggx_lambda(wi, alpha));
}
static inline float ggx_reflection(const float alpha, const float3 wo, const float3 wi, const float3 m) {
  return ggx_density(m, alpha) / (4.0f * wo.z * (1.0f + ggx_lambda(wo, alpha) + ggx_lambda(wi, alpha)));
}

// f cos [1/sr]
static inline float3 rough_dielectric_eval(const PointMaterial p, const float3 wo, const float3 wi) {
  const float alpha = p.alpha, eta = p.eta;
  if (wo.z <= 0 || wi.z == 0) return (float3)(0.0f);
  if (wi.z > 0) {
    const float3 m = reflecting_normal(wo, wi);
    return (float3)(fresnel_dielectric(dot(wo, m), eta) * ggx_reflection(alpha, wo, wi, m));
  }
  const float3 m = refracting_normal(wo, wi, eta);
  return p.color * ((1.0f - fresnel_dielectric(clamp(dot(wo, m), 0.0f, 1.0f), eta)) * ggx_refraction(alpha, eta, wo, wi, m));
}

static inline float rough_dielectric_pdf(const PointMaterial p, const float3 wo, const float3 wi) {
  const float alpha = p.alpha, eta = p.eta;
  if (wo.z <= 0 || wi.z == 0) return 0.0f;
  if (wi.z > 0) {
    const float3 m = reflecting_normal(wo, wi);
    const float cosine = dot(wo, m);
    return fresnel_dielectric(cosine, eta) * ggx_visible_density(wo, m, alpha) / (4.0f * cosine);
  }
  const float3 m = refracting_normal(wo, wi, eta);
  if (dot(wo, m) <= 0 || dot(wi, m) >= 0) return 0.0f;
  return (1.0f - fresnel_dielectric(dot(wo, m), eta)) * ggx_visible_density(wo, m, alpha) *
         refraction_jacobian(wo, wi, m, eta);
}

// choice: a third random number
static inline MaterialSample rough_dielectric_sample(const PointMaterial p, const float3 wo, const float2 u,
                                                     const float choice) {
  const float alpha = p.alpha, eta = p.eta;
  MaterialSample s;
  s.weight = 0.0f;
  s.pdf = 0.0f;
  s.direction = wo;
  if (wo.z <= 0) return s;
  const float3 m = ggx_visible_normal(wo, alpha, u);
  const float F = fresnel_dielectric(clamp(dot(wo, m), 0.0f, 1.0f), eta);
  const bool reflects = choice < F;
  float3 wi = 2.0f * dot(wo, m) * m - wo;
  if (!reflects && !refract_about(wo, m, eta, &wi)) return s;
  if (reflects != (wi.z > 0) || wi.z == 0) return s;  // would meet a second facet: lost
  const float lambda_o = ggx_lambda(wo, alpha), lambda_i = ggx_lambda(wi, alpha);
  s.direction = wi;
  s.pdf = rough_dielectric_pdf(p, wo, wi);
  s.weight = reflects ? (float3)((1.0f + lambda_o) / (1.0f + lambda_o + lambda_i)) : p.color / (1.0f + lambda_i);
  return s;
}
#endif
