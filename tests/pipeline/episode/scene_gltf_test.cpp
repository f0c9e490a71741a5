// The written scene as other programs find it: read again with tinygltf, points and light worked out by hand.
#include "pipeline/episode/scene_gltf.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "host/base/error.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/textures.hpp"
#include "host/formats/tinygltf.hpp"
#include "host/load/gltf_scene.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

using Kind = VisualMaterial::Kind;

VisualMesh triangle() {
  VisualMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

Scene example_scene() {
  Scene scene;
  scene.name = "example";
  scene.textures.push_back({2, 1, {255, 0, 0, 255, 0, 255, 0, 128}});
  for (const Kind kind : {Kind::diffuse, Kind::dielectric, Kind::emissive}) {
    VisualMaterial material;
    material.name = "material " + std::to_string(int(kind));
    material.kind = kind;
    scene.materials.push_back(material);
  }
  scene.materials[0].texture = 0;
  scene.materials[1].index_of_refraction = 1.47f;
  scene.materials[1].absorption = {6, 3, 0};
  scene.materials[2].emission = {2, 4, 8};
  scene.visual_meshes = {triangle()};
  RigidBody body;
  body.name = "body";
  scene.rigid_bodies = {body};
  for (int i = 0; i < 3; ++i) {
    Visual visual;
    visual.name = "visual " + std::to_string(i);
    visual.mesh = 0;
    visual.material = i;
    visual.pose.translation() = Vec3(0, 0, i);
    visual.rigid = i == 2 ? 0 : -1;
    scene.visuals.push_back(visual);
  }
  scene.lights.push_back({"lamp", {0, 0, 5}, {0, 1, 0}, {1, 0, 0}, {9, 9, 9}});
  Camera camera;
  camera.name = "front";
  camera.fx = camera.fy = 90;
  scene.cameras = {camera};
  return scene;
}

tinygltf::Model read_back(const std::filesystem::path& file) {
  tinygltf::Model model;
  tinygltf::TinyGLTF reader;
  std::string error, warning;
  reader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  EXPECT_TRUE(reader.LoadBinaryFromFile(&model, &error, &warning, file.string())) << error;
  return model;
}

double number(const tinygltf::Material& material, const std::string& extension, const std::string& key) {
  return material.extensions.at(extension).Get(key).GetNumberAsDouble();
}

TEST(SceneGltf, HoldsMaterialsLightsAndCamerasAsTheFormatSaysThem) {
  const TestFolder folder;
  SceneState state;
  state.rigid = {AffineMap::Zero()};
  state.rigid[0].leftCols<3>() = Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()).toRotationMatrix();
  state.rigid[0].col(3) = Vec3(10, 0, 0);
  write_scene_gltf(folder.path / "a.glb", example_scene(), state);
  const tinygltf::Model model = read_back(folder.path / "a.glb");

  ASSERT_EQ(model.materials.size(), 4u);
  const tinygltf::Material& glass = model.materials[1];
  EXPECT_EQ(number(glass, "KHR_materials_transmission", "transmissionFactor"), 1);
  EXPECT_NEAR(number(glass, "KHR_materials_ior", "ior"), 1.47, 1e-6);
  // colour c at depth d: absorption -ln c / d
  const double depth = number(glass, "KHR_materials_volume", "attenuationDistance");
  const tinygltf::Value& color = glass.extensions.at("KHR_materials_volume").Get("attenuationColor");
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(-std::log(color.Get(c).GetNumberAsDouble()) / depth, (std::array{6.0, 3.0, 0.0}[std::size_t(c)]), 1e-5);
  EXPECT_NEAR(number(model.materials[2], "KHR_materials_emissive_strength", "emissiveStrength"), 8, 1e-6);
  EXPECT_NEAR(model.materials[2].emissiveFactor[0], 0.25, 1e-6);
  EXPECT_EQ(model.materials[0].pbrMetallicRoughness.baseColorTexture.index, 0);
  EXPECT_EQ(model.images.size(), 1u);
  ASSERT_EQ(model.cameras.size(), 1u);
  EXPECT_NEAR(model.cameras[0].perspective.yfov, M_PI / 2, 1e-9);
  for (const char* used : {"KHR_materials_volume", "KHR_materials_ior"})
    EXPECT_EQ(std::count(model.extensionsUsed.begin(), model.extensionsUsed.end(), used), 1);

  // all of it turned back from y up: the third triangle's corner (1, 0, 2) goes with its body to (10, 1, 2)
  const VisualMesh all = read_visual_mesh(folder.path / "a.glb", 0);
  const auto has = [&](const Vec3f& p) {
    return std::any_of(all.points.begin(), all.points.end(), [&](const Vec3f& q) { return (p - q).norm() < 1e-5f; });
  };
  EXPECT_TRUE(has({1, 0, 1}));
  EXPECT_TRUE(has({10, 1, 2}));
  EXPECT_TRUE(has({1, 1, 5}));  // of the lamp
  EXPECT_FALSE(has({1, 0, 2}));
}

TEST(SceneGltf, IsReadBackWithItsMaterialsAndTextures) {
  const TestFolder folder;
  SceneState state;
  state.rigid = {AffineMap::Zero()};
  state.rigid[0].leftCols<3>() = Eigen::Matrix3d::Identity();
  Scene scene = example_scene();
  VisualMaterial captured;
  captured.name = "captured";
  captured.kind = Kind::shadow_receiver;
  scene.materials.push_back(captured);
  scene.visuals[0].material = 3;
  write_scene_gltf(folder.path / "a.glb", scene, state);
  const GltfScene read = read_gltf_scene(folder.path / "a.glb");
  ASSERT_EQ(read.parts.size(), 4u);  // three visuals and the lamp
  ASSERT_EQ(read.materials.size(), 5u);
  EXPECT_EQ(read.materials[0].kind, Kind::diffuse);
  ASSERT_EQ(read.materials[0].texture, 0);
  EXPECT_EQ(read.textures[0].rgba, scene.textures[0].rgba);
  const VisualMaterial& glass = read.materials[1];
  EXPECT_EQ(glass.kind, Kind::metallic_roughness);
  EXPECT_EQ(glass.transmission, 1);
  EXPECT_FALSE(glass.is_thin);
  EXPECT_NEAR(glass.index_of_refraction, 1.47, 1e-5);
  EXPECT_LT((glass.absorption - Vec3f(6, 3, 0)).norm(), 1e-3);
  EXPECT_LT((read.materials[2].emission - Vec3f(2, 4, 8)).norm(), 1e-4);
  EXPECT_EQ(read.materials[3].kind, Kind::shadow_receiver);
  EXPECT_EQ(read.parts[1].name, "visual 1");
  EXPECT_EQ(read.parts[1].material, 1);
  EXPECT_LT((read.parts[1].mesh.points[1] - Vec3f(1, 0, 1)).norm(), 1e-5);
  EXPECT_EQ(read.parts[0].mesh.uvs[1], Vec2f(1, 0));
}

TEST(SceneGltf, VertexColoursOfBytesAreReadAndHugePicturesRefused) {
  const TestFolder folder;
  // one triangle: 9 floats, then 3 colours of 4 bytes
  std::string bytes(48, '\0');
  const float points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::memcpy(bytes.data(), points, sizeof points);
  const unsigned char colors[12] = {255, 0, 0, 255, 0, 255, 0, 255, 51, 51, 51, 255};
  std::memcpy(bytes.data() + 36, colors, sizeof colors);
  folder.write("a.bin", bytes);
  folder.write("a.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}],
    "buffers": [{"uri": "a.bin", "byteLength": 48}]})");
  const GltfScene read = read_gltf_scene(folder.path / "a.gltf");
  ASSERT_EQ(read.parts.size(), 1u);
  EXPECT_EQ(read.parts[0].mesh.colors[1], Vec3f(0, 1, 0));
  EXPECT_NEAR(read.parts[0].mesh.colors[2].x(), 0.2, 1e-6);
  EXPECT_EQ(read.materials.size(), 1u);  // a plain one for what has none
  EXPECT_THROW(unpack_texture({1, 2, 3}, "noise"), UsageError);
  EXPECT_THROW(unpack_texture({}, "nothing"), UsageError);
}

TEST(SceneGltf, NamesTheFileThatCannotBeWritten) {
  try {
    write_scene_gltf("/nowhere/a.glb", Scene(), SceneState());
    FAIL() << "was written";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("/nowhere/a.glb"), std::string::npos);
  }
}

}  // namespace
}  // namespace pvg
