// A scene at one instant as a binary glTF (.glb), for Blender and other programs: visuals with their materials and
// textures, lights as emissive surfaces, cameras. Materials that glTF's metallic-roughness model lacks use
// the extensions KHR_materials_transmission, _ior, _volume, _emissive_strength, _specular, _sheen and _unlit
// (shadow receivers). What glTF cannot say is left out: lens distortion, even skies, and that receivers take shadows.
#pragma once
#include <filesystem>

#include "host/model/scene.hpp"
#include "host/model/state.hpp"

namespace pvg {

// The whole file or none; a Failure names it where it cannot be written.
void write_scene_gltf(const std::filesystem::path& file, const Scene& scene, const SceneState& state);

}  // namespace pvg
