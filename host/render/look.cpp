#include "host/render/look.hpp"

#include <cmath>
#include <cstring>

#include "host/base/error.hpp"
#include "host/pictures/srgb.hpp"
#include "materials/list.h"

namespace pvg {
namespace {

void copy(const Vec3f& from, f32 (&to)[3]) {
  for (int c = 0; c < 3; ++c) to[c] = from[c];
}

bool is_nonnegative(const Vec3f& v) { return v.allFinite() && v.minCoeff() >= 0; }

float roughness_to_alpha(float roughness) { return roughness * roughness; }

void check_within(const std::string& what, const Vec3f& value, float low, float high) {
  if (!(value.array() == value.array()).all() || value.minCoeff() < low || value.maxCoeff() > high)
    throw UsageError(what + " must be in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
}

void check(const VisualMaterial& material, std::size_t n_textures) {
  const std::string where = "material " + material.name + ": ";
  const bool is_reflectance = material.kind != VisualMaterial::Kind::emissive;
  const auto is_share = [](float x) { return x >= 0 && x <= 1; };
  if (!is_nonnegative(material.color) || (is_reflectance && material.color.maxCoeff() > 1))
    throw UsageError(where + "color must be in [0, 1]");
  if (!is_nonnegative(material.absorption)) throw UsageError(where + "absorption must not be negative [1/m]");
  if (!is_nonnegative(material.emission)) throw UsageError(where + "emission must not be negative [W/(sr m^2)]");
  if (!is_share(material.roughness)) throw UsageError(where + "roughness must be in [0, 1]");
  if (!is_share(material.metallic)) throw UsageError(where + "metallic must be in [0, 1]");
  if (!is_share(material.transmission)) throw UsageError(where + "transmission must be in [0, 1]");
  if (!(material.index_of_refraction >= 1 && material.index_of_refraction <= 4))
    throw UsageError(where + "index_of_refraction must be in [1, 4]");
  if (!is_share(material.opacity)) throw UsageError(where + "opacity must be in [0, 1]");
  if (!is_share(material.alpha_cutoff)) throw UsageError(where + "alpha_cutoff must be in [0, 1]");
  if (material.kind == VisualMaterial::Kind::dielectric && is_cut_out(material))
    throw UsageError(where + "a dielectric cannot be cut out by alpha; use metallic_roughness with transmission");
  if (!is_share(material.shadow_strength)) throw UsageError(where + "shadow_strength must be in [0, 1]");
  if (!(material.normal_scale >= 0 && material.normal_scale <= 100))
    throw UsageError(where + "normal_scale must be in [0, 100]");
  if (material.priority < 0 || material.priority > 1000) throw UsageError(where + "priority must be in [0, 1000]");
  for (const int texture :
       {material.texture, material.metallic_roughness_texture, material.normal_texture, material.emission_texture})
    if (texture >= int(n_textures)) throw UsageError(where + "its texture does not exist");
#define CHECK_COLOR(name, otherwise, low, high) check_within(where + #name, material.name, low, high);
#define CHECK_NUMBER(name, otherwise, low, high) check_within(where + #name, Vec3f::Constant(material.name), low, high);
  PVG_KIND_COLORS(CHECK_COLOR)
  PVG_KIND_NUMBERS(CHECK_NUMBER)
#undef CHECK_COLOR
#undef CHECK_NUMBER
}

#define SAME(ID, name, ...)                                                 \
  static_assert(MATERIAL_##ID == std::uint32_t(VisualMaterial::Kind::name), \
                #name ": the device's ids and VisualMaterial::Kind must agree");
PVG_MATERIALS(SAME, SAME)
#undef SAME

std::uint32_t device_kind(const VisualMaterial& material) {
  using Kind = VisualMaterial::Kind;
  const bool is_clear = roughness_to_alpha(material.roughness) < MIRROR_ALPHA;
  if (material.kind == Kind::dielectric && !is_clear)
    return std::uint32_t(material.is_thin ? MATERIAL_METALLIC_ROUGHNESS : MATERIAL_ROUGH_DIELECTRIC);
  // all of it clear glass: straight shadows can pass it
  const bool is_glass = material.kind == Kind::metallic_roughness && material.transmission == 1 &&
                        material.metallic == 0 && is_clear && material.texture < 0 &&
                        material.metallic_roughness_texture < 0 && material.emission.isZero() && !is_cut_out(material);
  return is_glass ? std::uint32_t(MATERIAL_DIELECTRIC) : std::uint32_t(material.kind);
}

// what its kind alone reads
void set_own(const VisualMaterial& material, Material& m) {
  using Kind = VisualMaterial::Kind;
#define SET_COLOR(name, member) \
  if (material.kind == Kind::name) copy(material.member, m.own_color);
#define SET_NUMBER(name, member) \
  if (material.kind == Kind::name) m.own_number = material.member;
  PVG_OWN_COLORS(SET_COLOR)
  PVG_OWN_NUMBERS(SET_NUMBER)
#undef SET_COLOR
#undef SET_NUMBER
}

bool has_inside(const VisualMaterial& material) { return transmits(material) && !material.is_thin; }

Material make_material(const VisualMaterial& material, std::size_t n_textures) {
  check(material, n_textures);
  Material m{};
  m.kind = device_kind(material);
  m.texture = material.texture;
  m.metallic_roughness_texture = material.metallic_roughness_texture;
  m.normal_texture = material.normal_texture;
  m.emission_texture = material.emission_texture;
  m.normal_scale = material.normal_scale;
  m.alpha = roughness_to_alpha(material.roughness);
  if (m.kind == MATERIAL_METALLIC_ROUGHNESS) m.alpha = std::max(m.alpha, MIRROR_ALPHA);
  m.ior = material.index_of_refraction;
  m.shadow_strength = material.shadow_strength;
  const bool is_clear = kind_of(material).traits & MATERIAL_CLEAR;
  m.metallic = is_clear ? 0 : material.metallic;
  m.transmission = is_clear ? 1 : material.transmission;
  m.priority = std::uint32_t(material.priority);
  m.flags = has_inside(material) ? MATERIAL_HAS_INSIDE : 0u;
  if (transmits(material) && material.is_thin) m.flags |= MATERIAL_THIN;
  if (shines(material)) m.flags |= MATERIAL_EMITS;
  if (is_cut_out(material))
    m.flags |= material.alpha_mode == VisualMaterial::AlphaMode::mask ? MATERIAL_MASK : MATERIAL_BLEND;
  m.flags |= std::uint32_t(material.on_second_uvs) * SECOND_UVS_COLOR;  // the bits stand in the same order
  m.opacity = material.opacity;
  m.alpha_cutoff = material.alpha_cutoff;
  copy(material.color, m.color);
  copy(material.absorption, m.absorption);
  copy(material.emission, m.emission);
  set_own(material, m);
  return m;
}

// textures whose bytes are values: those of roughness and normals
std::vector<bool> linear_textures(const Appearance& seen) {
  std::vector<bool> is_linear(seen.textures.size(), false);
  for (const VisualMaterial& material : seen.materials)
    for (const int texture : {material.metallic_roughness_texture, material.normal_texture})
      if (texture >= 0) is_linear.at(std::size_t(texture)) = true;
  for (const VisualMaterial& material : seen.materials)
    for (const int texture : {material.texture, material.emission_texture})
      if (texture >= 0 && is_linear[std::size_t(texture)])
        throw UsageError("material " + material.name +
                         ": one of its colour textures is used for roughness or normals, too; give each its own");
  return is_linear;
}

void add_textures(const Appearance& seen, Look& look) {
  const std::vector<bool> is_linear = linear_textures(seen);
  for (const Texture& texture : seen.textures) {
    if (texture.width < 1 || texture.height < 1 ||
        texture.rgba.size() != std::size_t(texture.width) * texture.height * 4)
      throw UsageError("texture " + std::to_string(look.textures.size()) + " has " +
                       std::to_string(texture.rgba.size()) + " bytes for " + std::to_string(texture.width) + " x " +
                       std::to_string(texture.height) + " RGBA texels");
    if (look.texels.size() + texture.rgba.size() / 4 > 0xffffffffu)
      throw UsageError("the textures have more than 4 billion texels together; scale them down");
    look.textures.push_back({std::uint32_t(look.texels.size()), std::uint32_t(texture.width),
                             std::uint32_t(texture.height), is_linear[look.textures.size()]});
    const std::size_t first = look.texels.size();
    look.texels.resize(first + texture.rgba.size() / 4);
    std::memcpy(look.texels.data() + first, texture.rgba.data(), texture.rgba.size());
  }
}

}  // namespace

Look make_look(const Appearance& seen) {
  Look look;
  look.material_of.resize(seen.materials.size());
  for (const bool is_glass : {true, false}) {
    for (std::size_t i = 0; i < seen.materials.size(); ++i) {
      if (has_inside(seen.materials[i]) != is_glass) continue;
      look.material_of[i] = std::uint32_t(look.materials.size());
      look.materials.push_back(make_material(seen.materials[i], seen.textures.size()));
    }
    if (is_glass && look.materials.size() > 255)
      throw UsageError("the scene has more than 255 materials that light enters; let visuals share them");
  }
  add_textures(seen, look);
  for (int byte = 0; byte < 256; ++byte) look.decode.push_back(srgb_to_linear(float(byte) / 255.0f));
  for (int byte = 0; byte < 256; ++byte) look.decode.push_back(float(byte) / 255.0f);
  return look;
}

bool is_cut_out(const VisualMaterial& material) {
  const bool is_whole = material.texture < 0 && material.opacity == 1;
  switch (material.alpha_mode) {
    case VisualMaterial::AlphaMode::mask:
      return !(is_whole && material.alpha_cutoff <= 1);
    case VisualMaterial::AlphaMode::blend:
      return !is_whole;
    default:
      return false;
  }
}

bool is_mirror_like(const Material& material) {
  return material.kind == MATERIAL_DIELECTRIC || (material.kind == MATERIAL_CONDUCTOR && material.alpha < MIRROR_ALPHA);
}

bool shines(const VisualMaterial& material) {
  using Kind = VisualMaterial::Kind;
  return (material.kind == Kind::emissive || material.kind == Kind::metallic_roughness) &&
         material.emission.maxCoeff() > 0;
}

Vec3f mean_emission(const Appearance& seen, const VisualMaterial& material) {
  const int texture = material.kind == VisualMaterial::Kind::emissive ? material.texture : material.emission_texture;
  if (texture < 0) return material.emission;
  const std::vector<std::uint8_t>& rgba = seen.textures.at(std::size_t(texture)).rgba;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4)
    for (int c = 0; c < 3; ++c) sum[c] += srgb_to_linear(float(rgba[i + std::size_t(c)]) / 255.0f);
  return material.emission.cwiseProduct((sum * (4.0 / double(rgba.size()))).cast<float>());
}

}  // namespace pvg
