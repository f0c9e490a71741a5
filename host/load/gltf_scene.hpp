// What a glTF file shows: every primitive of every node with its own material. Materials are of the kind
// metallic_roughness, with KHR_materials_transmission, _ior, _volume and _emissive_strength; unlit ones become shadow
// receivers, those without specular reflection diffuse. Cameras and KHR_lights_punctual. y up in the file becomes z up.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/model/scene.hpp"

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
  std::vector<Camera> cameras;        // perspective ones
  std::vector<SphereLight> lights;    // of KHR_lights_punctual, see gltf_views.hpp
  std::string generator;              // the program that wrote the file, as the file says; may be empty
  std::vector<std::string> left_out;  // what was not understood, a sentence each
};

// Throws a UsageError that names the file and what is missing or broken in it.
GltfScene read_gltf_scene(const std::filesystem::path& file);

}  // namespace pvg
