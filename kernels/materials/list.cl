// The functions of a material by its id, made from the list of materials.
#ifndef PVG_MATERIALS_LIST_CL
#define PVG_MATERIALS_LIST_CL
#include "materials/list.h"

// no variadic macros: drivers refuse them in OpenCL C
#define NOTHING(ID, name, traits, nearest, meaning)

static inline uint material_traits(const uint kind) {
  switch (kind) {
#define CASE(ID, name, traits, nearest, meaning) \
  case MATERIAL_##ID:                            \
    return traits;
    PVG_MATERIALS(CASE, CASE)
    PVG_DERIVED_MATERIALS(CASE)
#undef CASE
    default:
      return 0u;
  }
}

// f cos [1/sr]
static inline float3 material_eval(const PointMaterial p, const float3 wo, const float3 wi) {
  switch (p.kind) {
#define CASE(ID, name, traits, nearest, meaning) \
  case MATERIAL_##ID:                            \
    return name##_eval(p, wo, wi);
    PVG_MATERIALS(CASE, NOTHING)
    PVG_DERIVED_MATERIALS(CASE)
#undef CASE
    default:
      return (float3)(0.0f);
  }
}

static inline float material_pdf(const PointMaterial p, const float3 wo, const float3 wi) {
  switch (p.kind) {
#define CASE(ID, name, traits, nearest, meaning) \
  case MATERIAL_##ID:                            \
    return name##_pdf(p, wo, wi);
    PVG_MATERIALS(CASE, NOTHING)
    PVG_DERIVED_MATERIALS(CASE)
#undef CASE
    default:
      return 0.0f;
  }
}

// choice: a third random number. direction.z < 0: what passed through the surface
static inline MaterialSample material_sample(const PointMaterial p, const float3 wo, const float2 u,
                                             const float choice) {
  switch (p.kind) {
#define CASE(ID, name, traits, nearest, meaning) \
  case MATERIAL_##ID:                            \
    return name##_sample(p, wo, u, choice);
    PVG_MATERIALS(CASE, NOTHING)
    PVG_DERIVED_MATERIALS(CASE)
#undef CASE
    default:
      return diffuse_sample(p, wo, u, choice);  // never asked: paths end there
  }
}
#undef NOTHING

// a light sample can reach the eye by this material
static inline bool material_scatters(const PointMaterial p) {
  return !(material_traits(p.kind) & MATERIAL_MIRROR) || p.alpha >= MIRROR_ALPHA;
}

// light goes through the surface
static inline bool material_transmits(const PointMaterial p) {
  const uint traits = material_traits(p.kind);
  return (traits & MATERIAL_CLEAR) || ((traits & MATERIAL_TRANSMITS) && p.transmission > 0);
}

// lit evenly enough that a straight shadow through clear glass will do for it, see shade_path.cl
static inline bool material_is_matte(const PointMaterial p) {
  return (material_traits(p.kind) & MATERIAL_MATTE) && p.metallic < 0.5f && p.transmission < 0.5f;
}
#endif
