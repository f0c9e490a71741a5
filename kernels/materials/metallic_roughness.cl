// glTF's metallic-roughness model with KHR_materials_transmission, _volume and _ior. Between a metal and a dielectric
// coat over a base, by `metallic`:
//   coat        F D G2 / (4 cos_o),  F: metallic mix of Fresnel's equations and of Schlick's from the base colour
//   diffuse     (1 - metallic) (1 - transmission) color / pi * (1 - F(o)) (1 - F(i)) / (1 - F_mean) cos_i
//               (Kelemen and Szirmay-Kalos 2001: what the coat reflects is missing below it, in both directions)
//   transmitted (1 - metallic) transmission color (1 - F), refracted by the facets of a solid; through a thin sheet
//               straight on, blurred as the reflection is
// The mean reflectance of Fresnel's equations by the fit of Kulla and Conty 2017, (n - 1) / (4.08567 + 1.00071 n).
// One lobe is chosen, the weight is f cos / pdf of all of them together.
#ifndef PVG_MATERIALS_METALLIC_ROUGHNESS_CL
#define PVG_MATERIALS_METALLIC_ROUGHNESS_CL
#include "materials/conductor.cl"
#include "materials/diffuse.cl"
#include "materials/material.h"
#include "materials/rough_dielectric.cl"

static inline float coat_fresnel(const PointMaterial p, const float cosine) {
  const float c = clamp(cosine, 0.0f, 1.0f);
  return p.flags & MATERIAL_THIN ? fresnel_sheet(c, p.eta) : fresnel_dielectric(c, p.eta);
}

// share of the facets' light that is transmitted when chosen by luminance; F: of the coat
static inline float transmitted_share(const PointMaterial p, const float F, const float3 reflected) {
  const float3 luminance = (float3)(0.2126f, 0.7152f, 0.0722f);
  const float passes = (1.0f - p.metallic) * p.transmission * (1.0f - F) * dot(luminance, p.color);
  return passes > 0 ? passes / (passes + dot(luminance, reflected)) : 0.0f;
}

static inline float3 coat_reflectance(const PointMaterial p, const float cosine, const float F) {
  return mix((float3)(F), fresnel_schlick(p.color, cosine), p.metallic);
}

// probability of the diffuse lobe
static inline float diffuse_share(const PointMaterial p, const float3 wo) {
  const float3 luminance = (float3)(0.2126f, 0.7152f, 0.0722f);
  const float F = coat_fresnel(p, wo.z);
  const float diffuse = (1.0f - p.metallic) * (1.0f - p.transmission) * (1.0f - F) * dot(luminance, p.color);
  const float facets = dot(luminance, coat_reflectance(p, wo.z, F)) +
                       (1.0f - p.metallic) * p.transmission * (1.0f - F) * dot(luminance, p.color);
  return diffuse > 0 ? diffuse / (diffuse + facets) : 0.0f;
}

// f cos [1/sr]
static inline float3 metallic_roughness_eval(const PointMaterial p, const float3 wo, const float3 wi) {
  if (wo.z <= 0 || wi.z == 0) return (float3)(0.0f);
  const float base = 1.0f - p.metallic;
  if (wi.z < 0) {
    if (p.transmission == 0) return (float3)(0.0f);
    if (p.flags & MATERIAL_THIN) {
      const float3 mirrored = (float3)(wi.x, wi.y, -wi.z), m = reflecting_normal(wo, mirrored);
      return p.color * (base * p.transmission * (1.0f - coat_fresnel(p, dot(wo, m))) *
                        ggx_reflection(p.alpha, wo, mirrored, m));
    }
    const float3 m = refracting_normal(wo, wi, p.eta);
    return p.color * (base * p.transmission * (1.0f - coat_fresnel(p, dot(wo, m))) *
                      ggx_refraction(p.alpha, p.eta, wo, wi, m));
  }
  const float3 m = reflecting_normal(wo, wi);
  const float cosine = dot(wo, m), F = coat_fresnel(p, cosine);
  const float3 coat = coat_reflectance(p, cosine, F) * ggx_reflection(p.alpha, wo, wi, m);
  const float mean = p.eta > 1.0f ? (p.eta - 1.0f) / (4.08567f + 1.00071f * p.eta) : 0.0f;
  const float below = base * (1.0f - p.transmission) * (1.0f - coat_fresnel(p, wo.z)) * (1.0f - coat_fresnel(p, wi.z)) /
                      (1.0f - mean);
  return coat + p.color * (below * wi.z * M_1_PI_F);
}

static inline float metallic_roughness_pdf(const PointMaterial p, const float3 wo, const float3 wi) {
  if (wo.z <= 0 || wi.z == 0) return 0.0f;
  const float diffuse = diffuse_share(p, wo);
  const bool is_sheet = p.flags & MATERIAL_THIN;
  const float3 up = (float3)(wi.x, wi.y, fabs(wi.z));
  const float3 m = wi.z > 0 || is_sheet ? reflecting_normal(wo, up) : refracting_normal(wo, wi, p.eta);
  const float cosine = dot(wo, m);
  if (cosine <= 0) return 0.0f;
  const float F = coat_fresnel(p, cosine), through = transmitted_share(p, F, coat_reflectance(p, cosine, F));
  const float facets = ggx_visible_density(wo, m, p.alpha);
  if (wi.z > 0)
    return diffuse * wi.z * M_1_PI_F + (1.0f - diffuse) * (1.0f - through) * facets / (4.0f * cosine);
  if (is_sheet) return (1.0f - diffuse) * through * facets / (4.0f * cosine);
  return dot(wi, m) < 0 ? (1.0f - diffuse) * through * facets * refraction_jacobian(wo, wi, m, p.eta) : 0.0f;
}

static inline MaterialSample metallic_roughness_sample(const PointMaterial p, const float3 wo, const float2 u,
                                                       const float choice) {
  MaterialSample s;
  s.weight = 0.0f;
  s.pdf = 0.0f;
  s.direction = wo;
  if (wo.z <= 0) return s;
  const float diffuse = diffuse_share(p, wo);
  float3 wi;
  if (choice < diffuse) {
    wi = diffuse_sample(p, wo, u, choice).direction;
  } else {
    const float3 m = ggx_visible_normal(wo, p.alpha, u);
    const float cosine = dot(wo, m), F = coat_fresnel(p, cosine);
    const float rest = (choice - diffuse) / (1.0f - diffuse);  // again uniform
    const bool passes = rest < transmitted_share(p, F, coat_reflectance(p, cosine, F));
    wi = 2.0f * cosine * m - wo;
    if (passes && (p.flags & MATERIAL_THIN))
      wi.z = -wi.z;
    else if (passes && !refract_about(wo, m, p.eta, &wi))
      return s;
    if (passes == (wi.z > 0)) return s;  // would meet a second facet: lost
  }
  s.pdf = metallic_roughness_pdf(p, wo, wi);
  if (!(s.pdf > 0)) return s;
  s.direction = wi;
  s.weight = metallic_roughness_eval(p, wo, wi) / s.pdf;
  return s;
}
#endif
