// The list of materials that scatter: id to function. A new one: its file, and one line in each switch.
#ifndef PVG_MATERIALS_LIST_CL
#define PVG_MATERIALS_LIST_CL
#include "materials/conductor.cl"
#include "materials/dielectric.cl"
#include "materials/diffuse.cl"
#include "materials/material.h"

// f cos [1/sr]; color: of the material at this point, texture included
inline float3 material_eval(const Material m, const float3 color, const float3 wo, const float3 wi) {
  switch (m.kind) {
    case MATERIAL_DIFFUSE:
      return diffuse_eval(color, wo, wi);
    case MATERIAL_CONDUCTOR:
      return conductor_eval(color, m.alpha, wo, wi);
    default:
      return (float3)(0.0f);
  }
}

inline float material_pdf(const Material m, const float3 wo, const float3 wi) {
  switch (m.kind) {
    case MATERIAL_DIFFUSE:
      return diffuse_pdf(wo, wi);
    case MATERIAL_CONDUCTOR:
      return conductor_pdf(m.alpha, wo, wi);
    default:
      return 0.0f;
  }
}

// eta: index of refraction behind / in front of the surface, for dielectrics
inline MaterialSample material_sample(const Material m, const float3 color, const float eta, const float3 wo,
                                      const float2 u) {
  switch (m.kind) {
    case MATERIAL_CONDUCTOR:
      return conductor_sample(color, m.alpha, wo, u);
    case MATERIAL_DIELECTRIC:
      return dielectric_sample(eta, wo, u.x);
    default:
      return diffuse_sample(color, wo, u);
  }
}

// a light sample can reach the eye by this material
inline bool material_scatters(const Material m) {
  return m.kind == MATERIAL_DIFFUSE || (m.kind == MATERIAL_CONDUCTOR && m.alpha >= MIRROR_ALPHA);
}
#endif
