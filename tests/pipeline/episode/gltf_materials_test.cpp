// Materials of glTF files: alpha modes, sets of texture coordinates and KHR_texture_transform.
#include <gtest/gtest.h>

#include <cstring>

#include "host/base/error.hpp"
#include "host/formats/picture_files.hpp"
#include "host/load/gltf_scene.hpp"
#include "pipeline/episode/scene_gltf.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

// One triangle with the coordinates (0,0) (1,0) (0,1) and (0.5,0) (0.5,1) (0.25,0), one picture, and this material.
std::filesystem::path file_with_material(const TestFolder& folder, const std::string& material,
                                         bool has_second_uvs = true) {
  const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0.5f, 0, 0.5f, 1, 0.25f, 0};
  std::string bytes(sizeof numbers, '\0');
  std::memcpy(bytes.data(), numbers, sizeof numbers);
  folder.write("a.bin", bytes);
  const std::vector<std::uint8_t> png = encode_png({1, 1, {10, 20, 30, 40}});
  folder.write("a picture.png", {png.begin(), png.end()});
  const std::string second = has_second_uvs ? R"(, "TEXCOORD_1": 2)" : "";
  folder.write("a.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"name": "leaf", "primitives": [{"material": 0, "attributes": {"POSITION": 0, "TEXCOORD_0": 1)" +
                             second + R"(}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
                  {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24},
                    {"buffer": 0, "byteOffset": 60, "byteLength": 24}],
    "buffers": [{"uri": "a.bin", "byteLength": 84}], "images": [{"uri": "a%20picture.png"}], "textures": [{"source": 0}],
    "materials": [{"name": "green", )" +
                             material + "}]}");
  return folder.path / "a.gltf";
}

std::string refusal(const std::filesystem::path& file) {
  try {
    read_gltf_scene(file);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(GltfMaterials, AlphaModesAreRead) {
  using Mode = VisualMaterial::AlphaMode;
  const TestFolder folder;
  const auto read = [&](const std::string& material) {
    return read_gltf_scene(file_with_material(folder, material)).materials.at(0);
  };
  const VisualMaterial mask = read(R"("alphaMode": "MASK", "alphaCutoff": 0.3,
    "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.8], "baseColorTexture": {"index": 0}})");
  EXPECT_EQ(mask.alpha_mode, Mode::mask);
  EXPECT_EQ(mask.alpha_cutoff, 0.3f);
  EXPECT_EQ(mask.opacity, 0.8f);
  EXPECT_EQ(read(R"("alphaMode": "MASK")").alpha_cutoff, 0.5f);
  EXPECT_EQ(read(R"("alphaMode": "BLEND")").alpha_mode, Mode::blend);
  EXPECT_EQ(read(R"("doubleSided": true)").alpha_mode, Mode::opaque);
}

TEST(GltfMaterials, TexturesLieByTheirOwnCoordinates) {
  const TestFolder folder;
  const GltfScene scene = read_gltf_scene(file_with_material(folder, R"("normalTexture": {"index": 0, "texCoord": 1},
    "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}})"));
  EXPECT_EQ(scene.materials[0].on_second_uvs, unsigned(VisualMaterial::normal_bit));
  EXPECT_EQ(scene.parts[0].mesh.uvs[1], Vec2f(1, 0));
  EXPECT_EQ(scene.parts[0].mesh.second_uvs[1], Vec2f(0.5f, 1));
  // all of them by the second set: then it is the mesh's only one
  const GltfScene only = read_gltf_scene(file_with_material(folder, R"("normalTexture": {"index": 0, "texCoord": 1})"));
  EXPECT_EQ(only.materials[0].on_second_uvs, 0u);
  EXPECT_EQ(only.parts[0].mesh.uvs[1], Vec2f(0.5f, 1));
  EXPECT_TRUE(only.parts[0].mesh.second_uvs.empty());
}

// The specification's example: the lower left quadrant of the picture, turned by a quarter. v grows downward.
TEST(GltfMaterials, TextureTransformIsThatOfTheSpecification) {
  const TestFolder folder;
  const auto uvs = [&](const std::string& transform) {
    return read_gltf_scene(file_with_material(
                               folder, R"("emissiveTexture": {"index": 0, "extensions": {"KHR_texture_transform": )" +
                                           transform + "}}"))
        .parts[0]
        .mesh.uvs;
  };
  const std::vector<Vec2f> quarter = uvs(R"({"offset": [0, 1], "rotation": 1.57079632679, "scale": [0.5, 0.5]})");
  EXPECT_LT((quarter[0] - Vec2f(0, 1)).norm(), 1e-6);     // (0, 0): the lower left corner
  EXPECT_LT((quarter[1] - Vec2f(0, 0.5f)).norm(), 1e-6);  // (1, 0): half way up
  EXPECT_LT((quarter[2] - Vec2f(0.5f, 1)).norm(), 1e-6);  // (0, 1): half way to the right
  EXPECT_LT((uvs(R"({"offset": [0, 1], "scale": [1, -1]})")[2] - Vec2f(0, 0)).norm(), 1e-6);
  EXPECT_EQ(uvs(R"({"texCoord": 1})")[1], Vec2f(0.5f, 1));
}

TEST(GltfMaterials, PicturesBesideTheFileAreRead) {
  const TestFolder folder;
  const std::filesystem::path file = file_with_material(folder, R"("emissiveTexture": {"index": 0})");
  EXPECT_EQ(read_gltf_scene(file).textures.at(0).rgba, (std::vector<std::uint8_t>{10, 20, 30, 40}));
  std::filesystem::remove(folder.path / "a picture.png");
  EXPECT_NE(refusal(file).find("a picture.png"), std::string::npos) << refusal(file);
}

TEST(GltfMaterials, WhatCannotBeLaidOutIsRefused) {
  const TestFolder folder;
  const std::string third = refusal(file_with_material(folder, R"("normalTexture": {"index": 0, "texCoord": 2})"));
  EXPECT_NE(third.find("material `green`"), std::string::npos) << third;
  EXPECT_NE(third.find("a.gltf"), std::string::npos) << third;
  const std::string missing =
      refusal(file_with_material(folder, R"("normalTexture": {"index": 0, "texCoord": 1})", false));
  EXPECT_NE(missing.find("`leaf` has no TEXCOORD_1"), std::string::npos) << missing;
  const std::string many = refusal(file_with_material(folder, R"("normalTexture": {"index": 0, "texCoord": 1},
    "emissiveTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}},
    "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}})"));
  EXPECT_NE(many.find("more than two ways"), std::string::npos) << many;
}

TEST(GltfMaterials, AlphaAndSecondCoordinatesAreWrittenAndReadBack) {
  const TestFolder folder;
  Scene scene;
  scene.name = "cut";
  scene.textures.push_back({1, 1, {255, 255, 255, 128}});
  VisualMaterial material;
  material.name = "cut";
  material.kind = VisualMaterial::Kind::metallic_roughness;
  material.texture = 0;
  material.alpha_mode = VisualMaterial::AlphaMode::mask;
  material.opacity = 0.5f;
  material.alpha_cutoff = 0.25f;
  material.emission = {1, 1, 1};
  material.emission_texture = 0;
  material.on_second_uvs = VisualMaterial::emission_bit;
  scene.materials = {material};
  VisualMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.second_uvs = {{0, 0}, {0.5f, 0}, {0, 0.5f}};
  mesh.triangles = {{0, 1, 2}};
  scene.visual_meshes = {mesh};
  Visual visual;
  visual.name = "leaf";
  visual.mesh = visual.material = 0;
  scene.visuals = {visual};
  write_scene_gltf(folder.path / "a.glb", scene, SceneState());
  const GltfScene read = read_gltf_scene(folder.path / "a.glb");
  EXPECT_EQ(read.materials[0].alpha_mode, VisualMaterial::AlphaMode::mask);
  EXPECT_EQ(read.materials[0].opacity, 0.5f);
  EXPECT_EQ(read.materials[0].alpha_cutoff, 0.25f);
  EXPECT_EQ(read.materials[0].on_second_uvs, unsigned(VisualMaterial::emission_bit));
  EXPECT_EQ(read.parts[0].mesh.uvs, mesh.uvs);
  EXPECT_EQ(read.parts[0].mesh.second_uvs, mesh.second_uvs);
  EXPECT_EQ(read.textures[0].rgba[3], 128);
}

}  // namespace
}  // namespace pvg
