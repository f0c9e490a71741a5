// The list of materials that scatter: id to function. A new one: its file, and one line in each switch.
#ifndef PVG_MATERIALS_LIST_CL
#define PVG_MATERIALS_LIST_CL
#include "materials/cloth.cl"
#include "materials/conductor.cl"
#include "materials/dielectric.cl"
#include "materials/diffuse.cl"
#include "materials/material.h"
#include "materials/metallic_roughness.cl"
#include "materials/rough_dielectric.cl"

// f cos [1/sr]
static inline float3 material_eval(const PointMaterial p, const float3 wo, const float3 wi) {
  switch (p.kind) {
    case MATERIAL_DIFFUSE:
      return diffuse_eval(p.color, wo, wi);
    case MATERIAL_CONDUCTOR:
      return conductor_eval(p.color, p.sheen, p.alpha, wo, wi);
    case MATERIAL_METALLIC_ROUGHNESS:
      return metallic_roughness_eval(p, wo, wi);
    case MATERIAL_CLOTH:
      return cloth_eval(p.color, p.sheen, p.sheen_roughness, wo, wi);
    case MATERIAL_ROUGH_DIELECTRIC:
      return rough_dielectric_eval(p.color, p.alpha, p.eta, wo, wi);
    default:
      return (float3)(0.0f);
  }
}

static inline float material_pdf(const PointMaterial p, const float3 wo, const float3 wi) {
  switch (p.kind) {
    case MATERIAL_DIFFUSE:
      return diffuse_pdf(wo, wi);
    case MATERIAL_CONDUCTOR:
      return conductor_pdf(p.alpha, wo, wi);
    case MATERIAL_METALLIC_ROUGHNESS:
      return metallic_roughness_pdf(p, wo, wi);
    case MATERIAL_CLOTH:
      return cloth_pdf(wo, wi);
    case MATERIAL_ROUGH_DIELECTRIC:
      return rough_dielectric_pdf(p.alpha, p.eta, wo, wi);
    default:
      return 0.0f;
  }
}

// choice: a third random number. direction.z < 0: what passed through the surface
static inline MaterialSample material_sample(const PointMaterial p, const float3 wo, const float2 u,
                                             const float choice) {
  switch (p.kind) {
    case MATERIAL_CONDUCTOR:
      return conductor_sample(p.color, p.sheen, p.alpha, wo, u);
    case MATERIAL_DIELECTRIC:
      return p.flags & MATERIAL_THIN ? sheet_sample(p.color, p.eta, wo, choice) : dielectric_sample(p.color, p.eta, wo, choice);
    case MATERIAL_METALLIC_ROUGHNESS:
      return metallic_roughness_sample(p, wo, u, choice);
    case MATERIAL_CLOTH:
      return cloth_sample(p.color, p.sheen, p.sheen_roughness, wo, u, choice);
    case MATERIAL_ROUGH_DIELECTRIC:
      return rough_dielectric_sample(p.color, p.alpha, p.eta, wo, u, choice);
    default:
      return diffuse_sample(p.color, wo, u);
  }
}

// a light sample can reach the eye by this material
static inline bool material_scatters(const PointMaterial p) {
  return p.kind != MATERIAL_DIELECTRIC && (p.kind != MATERIAL_CONDUCTOR || p.alpha >= MIRROR_ALPHA);
}

// light goes through the surface
static inline bool material_transmits(const PointMaterial p) {
  return p.kind == MATERIAL_DIELECTRIC || p.kind == MATERIAL_ROUGH_DIELECTRIC ||
         (p.kind == MATERIAL_METALLIC_ROUGHNESS && p.transmission > 0);
}

// lit evenly enough that a straight shadow through clear glass will do for it, see shade.cl
static inline bool material_is_matte(const PointMaterial p) {
  return p.kind == MATERIAL_DIFFUSE || p.kind == MATERIAL_CLOTH ||
         (p.kind == MATERIAL_METALLIC_ROUGHNESS && p.metallic < 0.5f && p.transmission < 0.5f);
}
#endif
