// The materials of a glTF file and the textures that they use. Internal to the readers of glTF.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <vector>

#include "host/formats/tinygltf.hpp"
#include "host/model/scene.hpp"

namespace pvg {

// Where a texture lies on a mesh: a set of the mesh's texture coordinates, moved by KHR_texture_transform.
struct TextureLayout {
  int set = 0;                                                                // TEXCOORD_...
  Eigen::Matrix<double, 2, 3> map = Eigen::Matrix<double, 2, 3>::Identity();  // [A | offset]
  bool operator==(const TextureLayout& other) const { return set == other.set && map == other.map; }
};

struct GltfMaterial {
  VisualMaterial material;
  std::vector<TextureLayout> layouts;  // up to two: of VisualMesh::uvs and second_uvs
};

// Textures are unpacked once per use as colours or values.
class GltfMaterialReader {
 public:
  // textures: filled with those that the materials use
  GltfMaterialReader(const tinygltf::Model& model, const std::filesystem::path& file, std::vector<Texture>& textures)
      : model_(model), file_(file), textures_(textures) {}
  GltfMaterial read(const tinygltf::Material& from);

 private:
  [[noreturn]] void fail(const std::string& what) const;
  int texture(int index, bool is_linear);  // index in textures, -1: none
  template <class TextureInfo>
  int place(const TextureInfo& info, bool is_linear, unsigned bit, GltfMaterial& to);
  TextureLayout layout_of(int set, const tinygltf::ExtensionMap& extensions, const std::string& material) const;

  const tinygltf::Model& model_;
  const std::filesystem::path& file_;
  std::vector<Texture>& textures_;
  std::map<std::pair<int, bool>, int> known_;  // picture, as values -> texture
};

}  // namespace pvg
