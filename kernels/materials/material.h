// A material on the device. Kinds: list.h.
#ifndef PVG_MATERIALS_MATERIAL_H
#define PVG_MATERIALS_MATERIAL_H
#include "shared/types.h"

// below this GGX alpha a conductor is a mirror and a dielectric is clear
#define MIRROR_ALPHA 1e-3f

// flags
#define MATERIAL_THIN 1u        // a sheet without inside: what passes goes straight on
#define MATERIAL_HAS_INSIDE 2u  // paths enter it: a solid that transmits
#define MATERIAL_EMITS 4u       // its triangles are among the lights
#define MATERIAL_MASK 8u        // holes where alpha is below alpha_cutoff, see kernels/render/cutout.cl
#define MATERIAL_BLEND 16u      // lets 1 - alpha of the light go straight on

// textures that the mesh's second coordinates lay out: these bits of flags
#define SECOND_UVS_COLOR (1u << 8)
#define SECOND_UVS_METALLIC_ROUGHNESS (2u << 8)
#define SECOND_UVS_NORMAL (4u << 8)
#define SECOND_UVS_EMISSION (8u << 8)

SHARED_BEGIN
typedef struct {
  u32 kind;             // MATERIAL_...
  i32 texture;          // multiplies color, of emissive ones emission; -1: none
  f32 alpha;            // GGX width, roughness^2
  f32 ior;              // index of refraction
  f32 color[3];         // linear Rec. 709: albedo, reflectance at normal incidence, or tint of what passes
  f32 shadow_strength;  // lambda_s
  f32 absorption[3];    // [1/m]
  f32 metallic;         // 0: dielectric, 1: metal
  f32 emission[3];      // [W/(sr m^2)]
  f32 transmission;     // share of the light below the surface that passes instead of being scattered back
  f32 own_color[3];     // what its kind alone reads: PVG_OWN_COLORS and PVG_OWN_NUMBERS of list.h
  f32 own_number;
  i32 metallic_roughness_texture;  // green: multiplies roughness, blue: metallic; -1: none
  i32 normal_texture, emission_texture;
  f32 normal_scale;
  u32 flags;     // MATERIAL_...
  u32 priority;  // of overlapping solids the highest is there
  f32 opacity;       // multiplies the alpha of the texture
  f32 alpha_cutoff;  // of a mask
} Material;
SHARED_SIZE(Material, 112);

typedef struct {
  u32 first;  // of its texels
  u32 width, height;
  u32 is_linear;  // 1: bytes are values, not colours
} TextureInfo;
SHARED_SIZE(TextureInfo, 16);
SHARED_END

#ifdef __OPENCL_C_VERSION__
// a material at one point of a surface, its textures looked up
typedef struct {
  uint kind, flags;
  float3 color;
  float alpha, metallic, transmission;
  float eta;  // index of refraction behind / in front of the surface
  float3 own_color;
  float own_number;
} PointMaterial;

static inline PointMaterial point_material(const Material m, const float eta) {
  PointMaterial p;
  p.kind = m.kind;
  p.flags = m.flags;
  p.color = vload3(0, m.color);
  p.alpha = m.alpha;
  p.metallic = m.metallic;
  p.transmission = m.transmission;
  p.eta = eta;
  p.own_color = vload3(0, m.own_color);
  p.own_number = m.own_number;
  return p;
}
#endif
#endif
