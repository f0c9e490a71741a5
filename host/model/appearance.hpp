// What is seen of a scene, by which cameras, in which light, as plain structs. SI units, radians; z up. Colours are
// linear Rec. 709. Indices refer to the vectors of the same Appearance, those of bodies to the PhysicalScene beside it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "host/geometry/visual_mesh.hpp"
#include "host/pictures/picture.hpp"
#include "materials/list.h"

namespace pvg {

using Pose = Eigen::Isometry3d;

// What of glTF shows a kind best: its base alone, a metal, glass, light, a picture without light, all of it, or fibres.
enum class GltfModel { plain, metal, glass, shining, unlit, coated, cloth };

// docs/guide/pictures.md says what each kind is. Indices of textures are -1: none.
struct VisualMaterial {
#define PVG_KIND(ID, name, ...) name,
  enum class Kind { PVG_MATERIALS(PVG_KIND, PVG_KIND) };
#undef PVG_KIND
  enum class AlphaMode { opaque, mask, blend };
  std::string name;
  Kind kind = Kind::diffuse;
  Vec3f color = Vec3f::Constant(0.5f);   // linear Rec. 709: albedo, reflectance at normal incidence of a conductor, or
                                         // tint of what passes a dielectric's surface
  int texture = -1;                      // multiplies color, of emissive ones emission
  float roughness = 0.3f;                // GGX alpha = roughness^2; of a dielectric 0 is clear
  float index_of_refraction = 1.5f;      // of dielectrics and the coat of metallic_roughness
  Vec3f absorption = Vec3f::Zero();      // inside, Beer-Lambert [1/m]
  Vec3f emission = Vec3f::Zero();        // radiance of emissive and metallic_roughness surfaces [W/(sr m^2)]
  float shadow_strength = 1;             // lambda_s of the shadow receiver, in [0, 1]
  float metallic = 0, transmission = 0;  // of metallic_roughness, in [0, 1]
  bool is_thin = false;                  // a sheet without inside, of what transmits
  int priority = 0;                      // of overlapping solids that transmit the highest is there
  int metallic_roughness_texture = -1;   // plain values: green multiplies roughness, blue metallic
  int normal_texture = -1, emission_texture = -1;  // plain values; sRGB
  float normal_scale = 1;
  // bits of those textures that are laid out by VisualMesh::second_uvs
  enum TextureBit : unsigned { color_bit = 1, metallic_roughness_bit = 2, normal_bit = 4, emission_bit = 8 };
  unsigned on_second_uvs = 0;
#define PVG_COLOR(name, otherwise, ...) Vec3f name = Vec3f::Constant(otherwise);
#define PVG_NUMBER(name, otherwise, ...) float name = otherwise;
  PVG_KIND_COLORS(PVG_COLOR)
  PVG_KIND_NUMBERS(PVG_NUMBER)
#undef PVG_COLOR
#undef PVG_NUMBER
  AlphaMode alpha_mode = AlphaMode::opaque;  // alpha: opacity times the texture's; mask: holes where it is below
  float opacity = 1, alpha_cutoff = 0.5f;    // alpha_cutoff; blend: 1 - alpha of the light goes straight on
};

// A row of the list of materials, in the order of VisualMaterial::Kind.
struct MaterialKind {
  const char* name;
  unsigned traits;  // MATERIAL_...
  GltfModel gltf;
  const char* meaning;
};
#define PVG_KIND(ID, name, traits, gltf, meaning) MaterialKind{#name, traits, GltfModel::gltf, meaning},
inline constexpr MaterialKind MATERIAL_KINDS[] = {PVG_MATERIALS(PVG_KIND, PVG_KIND)};
#undef PVG_KIND
inline const MaterialKind& kind_of(const VisualMaterial& material) {
  return MATERIAL_KINDS[std::size_t(material.kind)];
}
inline bool transmits(const VisualMaterial& material) {
  const unsigned traits = kind_of(material).traits;
  return (traits & MATERIAL_CLEAR) || ((traits & MATERIAL_TRANSMITS) && material.transmission > 0);
}

// One visible thing. It follows a rigid body, a soft body (its mesh is then embedded in the body's tetrahedra, or
// without one made by subdivision of its surface), a cloth (whose surface is subdivided), or nothing.
struct Visual {
  std::string name;
  int mesh = -1;  // of Appearance::visual_meshes; -1: of a soft body or cloth: made from its surface
  int material = -1;
  int rigid = -1, soft = -1, cloth = -1;  // body it follows; all -1: stands still
  Pose pose = Pose::Identity();           // mesh to body (or to world)
  int subdivision_levels = 1;             // of a soft body's or cloth's surface
  std::string part;                       // label in the segmentation masks, such as "gripper"
  bool casts_shadow_on_receivers = true;  // false for the captured background itself
};

// A rectangular area light, emitting on the side of cross(edge_u, edge_v).
struct RectangleLight {
  std::string name;
  Vec3 corner, edge_u, edge_v;  // world [m]
  Vec3f radiance;               // linear Rec. 709 [W/(sr m^2)]
};

// A ball that shines.
struct SphereLight {
  std::string name;
  Vec3 center = Vec3::Zero();  // world [m]
  double radius = 0;           // [m]
  Vec3f radiance;              // linear Rec. 709 [W/(sr m^2)]
  // of a spot: what is within the inner angle about its direction sees it shine, what is beyond the outer one does not
  Vec3 direction = -Vec3::UnitZ();
  double inner_angle = 4, outer_angle = 4;  // [rad]; above pi: shines everywhere
};

// A camera; the frame is optical (x right, y down, z forward). As in OpenCV, pixel (0, 0) is the centre of the top left
// pixel. What a real camera adds is off by default.
struct Camera {
  enum class Model { pinhole, fisheye };
  std::string name;
  int width = 320, height = 180;          // [pixels]
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [pixels]
  Model model = Model::pinhole;
  std::vector<double> distortion;  // OpenCV k1 k2 p1 p2 k3 ..., of a fisheye k1 k2 k3 k4; empty: none
  int rigid = -1;                  // body it is mounted on; -1: world
  Pose pose = Pose::Identity();    // camera to body (or world)
  float exposure = 1;              // multiplies radiance
  double lens_radius = 0;          // of the aperture [m]; 0: everything is sharp
  double focus_distance = 1;       // along the optical axis [m]
  double exposure_time = 0;        // the shutter is open so long before the picture's time [s]
  double row_time = 0;             // rolling shutter: a row is read so long after the one above [s]
  std::vector<double> vignetting;  // v1 v2 v3 of 1 + v1 r^2 + v2 r^4 + v3 r^6, r = 1 at the farthest corner
  double full_well = 0;            // electrons at value 1, whose number has shot noise; 0: none
  double read_noise = 0;           // one sigma [electrons]
};

// The shape of a rigid body that does not collide, so that it can be seen.
struct PassingSurface {
  int rigid = -1;
  TriangleMesh surface;  // in the body's frame
};

struct Appearance {
  std::vector<Texture> textures;
  std::vector<VisualMaterial> materials;
  std::vector<VisualMesh> visual_meshes;
  std::vector<Visual> visuals;
  std::vector<PassingSurface> passing_surfaces;  // seen where the scene has no visuals
  std::vector<RectangleLight> lights;
  std::vector<SphereLight> sphere_lights;
  Vec3f environment = Vec3f::Zero();  // radiance of every direction that no surface covers [W/(sr m^2)]
  EnvironmentMap environment_map;     // multiplied by `environment`
  std::vector<Camera> cameras;
};

}  // namespace pvg
