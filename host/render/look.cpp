#include "host/render/look.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

#include "host/base/error.hpp"

namespace pvg {
namespace {

void copy(const Vec3f& from, f32 (&to)[3]) {
  for (int c = 0; c < 3; ++c) to[c] = from[c];
}

bool is_nonnegative(const Vec3f& v) { return v.allFinite() && v.minCoeff() >= 0; }

Material make_material(const VisualMaterial& material, std::size_t n_textures) {
  const std::string where = "material " + material.name + ": ";
  const bool is_reflectance = material.kind != VisualMaterial::Kind::emissive;
  if (!is_nonnegative(material.color) || (is_reflectance && material.color.maxCoeff() > 1))
    throw UsageError(where + "color must be in [0, 1]");
  if (!is_nonnegative(material.absorption)) throw UsageError(where + "absorption must not be negative [1/m]");
  if (!is_nonnegative(material.emission)) throw UsageError(where + "emission must not be negative [W/(sr m^2)]");
  if (!(material.roughness >= 0 && material.roughness <= 1)) throw UsageError(where + "roughness must be in [0, 1]");
  if (!(material.index_of_refraction >= 1 && material.index_of_refraction <= 4))
    throw UsageError(where + "index_of_refraction must be in [1, 4]");
  if (!(material.shadow_strength >= 0 && material.shadow_strength <= 1))
    throw UsageError(where + "shadow_strength must be in [0, 1]");
  if (material.texture >= int(n_textures)) throw UsageError(where + "its texture does not exist");
  Material m{};
  m.kind = std::uint32_t(material.kind);
  m.texture = material.texture;
  m.alpha = material.roughness * material.roughness;
  m.ior = material.index_of_refraction;
  m.shadow_strength = material.shadow_strength;
  copy(material.color, m.color);
  copy(material.absorption, m.absorption);
  copy(material.emission, m.emission);
  return m;
}

void add_textures(const Scene& scene, Look& look) {
  for (const Texture& texture : scene.textures) {
    if (texture.width < 1 || texture.height < 1 ||
        texture.rgba.size() != std::size_t(texture.width) * texture.height * 4)
      throw UsageError("texture " + std::to_string(look.textures.size()) + " has " +
                       std::to_string(texture.rgba.size()) + " bytes for " + std::to_string(texture.width) + " x " +
                       std::to_string(texture.height) + " RGBA texels");
    look.textures.push_back(
        {std::uint32_t(look.texels.size()), std::uint32_t(texture.width), std::uint32_t(texture.height), 0});
    const std::size_t first = look.texels.size();
    look.texels.resize(first + texture.rgba.size() / 4);
    std::memcpy(look.texels.data() + first, texture.rgba.data(), texture.rgba.size());
  }
}

void add_lights(const Scene& scene, Look& look) {
  double total = 0;
  std::vector<double> powers;
  for (const RectangleLight& light : scene.lights) {
    const double area = light.edge_u.cross(light.edge_v).norm();
    if (!(area > 0) || !light.corner.allFinite()) throw UsageError("light " + light.name + ": its edges span no area");
    if (!is_nonnegative(light.radiance) || light.radiance.maxCoeff() <= 0)
      throw UsageError("light " + light.name + ": radiance must be positive");
    const Vec3f& L = light.radiance;
    powers.push_back(area * (0.2126 * L.x() + 0.7152 * L.y() + 0.0722 * L.z()));  // luminance, Rec. 709
    total += powers.back();
  }
  double sum = 0;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const RectangleLight& light = scene.lights[i];
    const Vec3 normal = light.edge_u.cross(light.edge_v);
    sum += powers[i];
    Light l{};
    copy(light.corner.cast<float>(), l.corner);
    copy(light.edge_u.cast<float>(), l.edge_u);
    copy(light.edge_v.cast<float>(), l.edge_v);
    copy(normal.normalized().cast<float>(), l.normal);
    copy(light.radiance, l.radiance);
    l.area = float(normal.norm());
    l.probability = float(powers[i] / total);
    l.cumulative = float(sum / total);
    look.lights.push_back(l);
  }
}

}  // namespace

Look make_look(const Scene& scene) {
  Look look;
  look.material_of.resize(scene.materials.size());
  for (const bool is_glass : {true, false}) {
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
      if ((scene.materials[i].kind == VisualMaterial::Kind::dielectric) != is_glass) continue;
      look.material_of[i] = std::uint32_t(look.materials.size());
      look.materials.push_back(make_material(scene.materials[i], scene.textures.size()));
    }
    if (is_glass && look.materials.size() > 255)
      throw UsageError("the scene has more than 255 dielectric materials; let visuals share them");
  }
  add_textures(scene, look);
  add_lights(scene, look);
  for (int byte = 0; byte < 256; ++byte) look.decode.push_back(srgb_to_linear(float(byte) / 255.0f));
  return look;
}

float srgb_to_linear(float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); }
float linear_to_srgb(float c) { return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f; }

}  // namespace pvg
