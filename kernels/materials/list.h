// The list of materials. From a row follow the id on the device, VisualMaterial::Kind, the name in scene files, the
// functions that shading calls, how glTF says it, and the shared tests (tests/render/material_test.cpp). The order is
// that of the ids.
//   SCATTERS  its file kernels/materials/<name>.cl, included below, has for a PointMaterial p and directions wo, wi of
//             the local frame (frame.cl):
//               float3 <name>_eval(p, wo, wi)                  f cos [1/sr]
//               float <name>_pdf(p, wo, wi)                    of the samples below [1/sr]
//               MaterialSample <name>_sample(p, wo, u, choice) u, choice: random numbers in [0, 1)
//   ENDS      paths end there: kernels/render/shade_path.cl says what they see
//   columns   ID, name, traits, nearest model in glTF (host/model/appearance.hpp), meaning
#ifndef PVG_MATERIALS_LIST_H
#define PVG_MATERIALS_LIST_H
#include "shared/types.h"

#define PVG_MATERIALS(SCATTERS, ENDS)                                                                                \
  SCATTERS(DIFFUSE, diffuse, MATERIAL_MATTE | MATERIAL_COLORED, plain, "Lambert")                                    \
  SCATTERS(CONDUCTOR, conductor, MATERIAL_MIRROR, metal, "metal")                                                    \
  SCATTERS(DIELECTRIC, dielectric, MATERIAL_MIRROR | MATERIAL_CLEAR, glass, "clear or frosted glass and water")      \
  ENDS(EMISSIVE, emissive, 0u, shining, "shines on both sides")                                                      \
  ENDS(SHADOW_RECEIVER, shadow_receiver, MATERIAL_COLORED, unlit,                                                    \
       "a captured surface that keeps its look and receives shadows")                                                \
  SCATTERS(METALLIC_ROUGHNESS, metallic_roughness, MATERIAL_MATTE | MATERIAL_COLORED | MATERIAL_TRANSMITS, coated,   \
           "glTF's model: a coat over a base")                                                                       \
  SCATTERS(CLOTH, cloth, MATERIAL_MATTE | MATERIAL_COLORED, cloth, "diffuse below fibres that shine at grazing angles")

// What the host makes of them: no file names it.
#define PVG_DERIVED_MATERIALS(SCATTERS) \
  SCATTERS(ROUGH_DIELECTRIC, rough_dielectric, MATERIAL_CLEAR, glass, "a dielectric that is rough")

// traits
#define MATERIAL_MATTE 1u       // scatters evenly, as far as it is neither metal nor transmits
#define MATERIAL_COLORED 2u     // gives its colour to what it scatters, as far as it does not transmit
#define MATERIAL_MIRROR 4u      // below MIRROR_ALPHA no light sample finds its directions
#define MATERIAL_TRANSMITS 8u   // the share `transmission` of the light that enters passes
#define MATERIAL_CLEAR 16u      // all light that enters passes

// Numbers that few kinds read: (name, default, lowest, highest). They are members of VisualMaterial; a row of
// PVG_OWN_NUMBERS says which color and which number a kind gets on the device as own_color and own_number.
#define PVG_KIND_COLORS(X)                                                                              \
  X(edge_dip, 0, -INFINITY, INFINITY) /* of a conductor: a of conductor.cl, 0: Schlick's curve */       \
  X(sheen, 0, 0, 1)                   /* of cloth: reflectance scale of its fibres */
#define PVG_KIND_NUMBERS(X)                                           \
  X(sheen_roughness, 0.7f, 0.5f, 1) /* of cloth */                    \
  X(ambient, 0, 0, 1) /* of the shadow receiver: its light from all around */
#define PVG_OWN_COLORS(X) X(conductor, edge_dip) X(cloth, sheen)
#define PVG_OWN_NUMBERS(X) X(cloth, sheen_roughness) X(shadow_receiver, ambient)

SHARED_BEGIN
#define PVG_ID(ID, name, traits, nearest, meaning) MATERIAL_##ID,
enum { PVG_MATERIALS(PVG_ID, PVG_ID) PVG_DERIVED_MATERIALS(PVG_ID) N_MATERIALS };
#undef PVG_ID
SHARED_END

#ifdef __OPENCL_C_VERSION__
#include "materials/cloth.cl"
#include "materials/conductor.cl"
#include "materials/dielectric.cl"
#include "materials/diffuse.cl"
#include "materials/metallic_roughness.cl"
#include "materials/rough_dielectric.cl"
#endif
#endif
