// What a glTF file shows: every primitive of every node with its own material. Materials are of the kind
// metallic_roughness, with KHR_materials_transmission, _ior, _volume and _emissive_strength; unlit ones become shadow
// receivers, those without specular reflection diffuse. y up in the file becomes z up.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace pvg {

struct GltfPart {
  std::string name;   // of its node
  int material = -1;  // of GltfScene::materials
  VisualMesh mesh;    // in the file's frame, z up [m]
};

struct GltfScene {
  std::vector<Texture> textures;  // that the materials' indices refer to
  std::vector<VisualMaterial> materials;
  std::vector<GltfPart> parts;
};

// Throws a UsageError that names the file and what is missing or broken in it.
GltfScene read_gltf_scene(const std::filesystem::path& file);

}  // namespace pvg
