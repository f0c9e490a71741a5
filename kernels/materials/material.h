// A material on the device. Kinds are those of VisualMaterial::Kind, in the same order, and the rectangle lights.
#ifndef PVG_MATERIALS_MATERIAL_H
#define PVG_MATERIALS_MATERIAL_H
#include "shared/types.h"

#define MATERIAL_DIFFUSE 0u
#define MATERIAL_CONDUCTOR 1u
#define MATERIAL_DIELECTRIC 2u
#define MATERIAL_EMISSIVE 3u
#define MATERIAL_SHADOW_RECEIVER 4u

// below this GGX alpha a conductor is a mirror
#define MIRROR_ALPHA 1e-3f

SHARED_BEGIN
typedef struct {
  u32 kind;             // MATERIAL_...
  i32 texture;          // multiplies color and emission; -1: none
  f32 alpha;            // GGX width, roughness^2
  f32 ior;              // index of refraction
  f32 color[3];         // linear Rec. 709: albedo, or reflectance at normal incidence
  f32 shadow_strength;  // lambda_s
  f32 absorption[3];    // [1/m]
  f32 unused0;
  f32 emission[3];  // [W/(sr m^2)]
  f32 unused1;
} Material;
SHARED_SIZE(Material, 64);

typedef struct {
  u32 first;  // of its texels
  u32 width, height;
  u32 unused;
} TextureInfo;
SHARED_SIZE(TextureInfo, 16);
SHARED_END
#endif
