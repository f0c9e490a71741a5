#include "host/load/gltf_materials.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "host/base/error.hpp"
#include "host/formats/textures.hpp"

namespace pvg {
namespace {

const tinygltf::Value* find(const tinygltf::ExtensionMap& from, const std::string& extension, const std::string& key) {
  const auto at = from.find(extension);
  return at != from.end() && at->second.Has(key) ? &at->second.Get(key) : nullptr;
}

double number(const tinygltf::ExtensionMap& from, const std::string& extension, const std::string& key,
              double otherwise) {
  const tinygltf::Value* value = find(from, extension, key);
  return value && value->IsNumber() ? value->GetNumberAsDouble() : otherwise;
}

// one of n numbers
double component(const tinygltf::ExtensionMap& from, const std::string& extension, const std::string& key, int i, int n,
                 double otherwise) {
  const tinygltf::Value* value = find(from, extension, key);
  return value && value->IsArray() && int(value->ArrayLen()) == n && value->Get(i).IsNumber()
             ? value->Get(i).GetNumberAsDouble()
             : otherwise;
}

// a URI's %20 and the like as characters
std::string decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool is_code = uri[i] == '%' && i + 2 < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
                         std::isxdigit(static_cast<unsigned char>(uri[i + 2]));
    text += is_code ? char(std::stoi(uri.substr(i + 1, 2), nullptr, 16)) : uri[i];
    if (is_code) i += 2;
  }
  return text;
}

}  // namespace

void GltfMaterialReader::fail(const std::string& what) const { throw UsageError(file_.string() + ": " + what + "."); }

GltfMaterial GltfMaterialReader::read(const tinygltf::Material& from) {
  using Bit = VisualMaterial::TextureBit;
  using Mode = VisualMaterial::AlphaMode;
  const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
  const tinygltf::ExtensionMap& more = from.extensions;
  GltfMaterial read;
  VisualMaterial& to = read.material;
  to.name = from.name;
  to.kind = VisualMaterial::Kind::metallic_roughness;
  to.color = Vec3f::Ones();
  for (std::size_t c = 0; c < 3 && c < pbr.baseColorFactor.size(); ++c)
    to.color[Eigen::Index(c)] = float(pbr.baseColorFactor[c]);
  to.texture = place(pbr.baseColorTexture, false, Bit::color_bit, read);
  to.alpha_mode = from.alphaMode == "MASK" ? Mode::mask : from.alphaMode == "BLEND" ? Mode::blend : Mode::opaque;
  if (pbr.baseColorFactor.size() == 4) to.opacity = float(pbr.baseColorFactor[3]);
  to.alpha_cutoff = float(from.alphaCutoff);
  to.metallic = float(pbr.metallicFactor);
  to.roughness = float(pbr.roughnessFactor);
  to.metallic_roughness_texture = place(pbr.metallicRoughnessTexture, true, Bit::metallic_roughness_bit, read);
  to.normal_texture = place(from.normalTexture, true, Bit::normal_bit, read);
  to.normal_scale = float(from.normalTexture.scale);
  for (std::size_t c = 0; c < 3 && c < from.emissiveFactor.size(); ++c)
    to.emission[Eigen::Index(c)] = float(from.emissiveFactor[c]);
  to.emission *= float(number(more, "KHR_materials_emissive_strength", "emissiveStrength", 1));
  to.emission_texture = place(from.emissiveTexture, false, Bit::emission_bit, read);
  to.transmission = float(number(more, "KHR_materials_transmission", "transmissionFactor", 0));
  to.index_of_refraction = float(number(more, "KHR_materials_ior", "ior", 1.5));
  to.is_thin = !(number(more, "KHR_materials_volume", "thicknessFactor", 0) > 0);
  const double depth = number(more, "KHR_materials_volume", "attenuationDistance", 0);
  if (depth > 0 && !to.is_thin)
    for (int c = 0; c < 3; ++c) {
      const double left = component(more, "KHR_materials_volume", "attenuationColor", c, 3, 1);
      to.absorption[c] = float(-std::log(std::max(1e-6, left)) / depth);
    }
  // a captured surface keeps its look; a surface without a coat is plain
  if (more.count("KHR_materials_unlit")) to.kind = VisualMaterial::Kind::shadow_receiver;
  if (to.metallic == 0 && to.transmission == 0 && to.emission.isZero() &&
      number(more, "KHR_materials_specular", "specularFactor", 1) == 0)
    to.kind = VisualMaterial::Kind::diffuse;
  return read;
}

// the texture, and which of the material's layouts is its own
template <class TextureInfo>
int GltfMaterialReader::place(const TextureInfo& info, bool is_linear, unsigned bit, GltfMaterial& to) {
  if (info.index < 0) return -1;
  const TextureLayout layout = layout_of(info.texCoord, info.extensions, to.material.name);
  std::size_t i = 0;
  while (i < to.layouts.size() && !(to.layouts[i] == layout)) ++i;
  if (i == 2)
    fail("material `" + to.material.name +
         "` lays its textures out in more than two ways (sets of coordinates, KHR_texture_transform); bake them");
  if (i == to.layouts.size()) to.layouts.push_back(layout);
  if (i == 1) to.material.on_second_uvs |= bit;
  return texture(info.index, is_linear);
}

TextureLayout GltfMaterialReader::layout_of(int set, const tinygltf::ExtensionMap& extensions,
                                            const std::string& material) const {
  const std::string moved = "KHR_texture_transform";
  TextureLayout layout;
  const double named = number(extensions, moved, "texCoord", set);
  if (named != 0 && named != 1)
    fail("a texture of material `" + material + "` uses a third set of coordinates (texCoord), two are read; bake it");
  layout.set = int(named);
  if (!extensions.count(moved)) return layout;
  const double angle = number(extensions, moved, "rotation", 0), c = std::cos(angle), s = std::sin(angle);
  const double su = component(extensions, moved, "scale", 0, 2, 1), sv = component(extensions, moved, "scale", 1, 2, 1);
  // v grows downward, so that this turns counter-clockwise as seen
  layout.map << c * su, s * sv, component(extensions, moved, "offset", 0, 2, 0),  //
      -s * su, c * sv, component(extensions, moved, "offset", 1, 2, 0);
  if (!layout.map.allFinite()) fail("KHR_texture_transform of material `" + material + "` is not finite");
  return layout;
}

int GltfMaterialReader::texture(int index, bool is_linear) {
  if (index >= int(model_.textures.size()) || model_.textures[std::size_t(index)].source < 0 ||
      model_.textures[std::size_t(index)].source >= int(model_.images.size()))
    fail("a material names a texture that does not exist");
  const int source = model_.textures[std::size_t(index)].source;
  const auto [at, is_new] = known_.insert({{source, is_linear}, int(textures_.size())});
  if (is_new) {
    const tinygltf::Image& image = model_.images[std::size_t(source)];
    const std::string name = image.name.empty() ? std::to_string(source) : image.name;
    textures_.push_back(image.image.empty() && !image.uri.empty()
                            ? read_texture(file_.parent_path() / decoded(image.uri))
                            : unpack_texture(image.image, file_.string() + ", picture " + name));
  }
  return at->second;
}

}  // namespace pvg
