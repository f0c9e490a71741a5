// The triangle meshes, cameras and lights of a glTF file with the transforms of their nodes. y up in the file becomes
// z up. Internal to the readers of glTF.
#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "host/formats/raw_mesh.hpp"
#include "host/formats/tinygltf.hpp"

namespace pvg {

// One primitive of one node.
struct GltfPrimitive {
  std::string name;
  int material = -1;
  RawMesh mesh;
  std::vector<Vec2f> second_uvs;  // [n] TEXCOORD_1, or empty
  std::vector<Vec3f> colors;      // [n] linear, or empty
};

// A camera or light of one node.
struct GltfPlaced {
  std::string name;
  int index = -1;  // of the model's cameras or lights
  Eigen::Affine3d to_world;
};

struct GltfNodes {
  std::vector<GltfPrimitive> primitives;
  std::vector<GltfPlaced> cameras, lights;
};

// Textures stay packed. Throws a UsageError that names the file where it cannot be read.
tinygltf::Model load_gltf(const std::filesystem::path& file);
GltfNodes read_gltf_nodes(const tinygltf::Model& model, const std::filesystem::path& file);

}  // namespace pvg
