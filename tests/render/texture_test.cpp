// Textures, normal maps and vertex colours where they are seen, each against a number by hand.
#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Textured = ManyPaths;

Texture plain(const std::array<std::uint8_t, 4>& texel) { return {1, 1, {texel.begin(), texel.end()}}; }

// a floor under an even sky would not show a bent normal; a far lamp straight above does: radiance goes with the cosine
Scene floor_under_lamp(const VisualMaterial& m) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), m);
  add_light(scene, {-0.5, -0.5, 100}, {0, 1, 0}, {1, 0, 0}, Vec3f::Constant(1e4f));
  look_at(scene, {0, -0.3, 1}, {0, 0, 0}, 16, 16, 1000);
  return scene;
}

TEST_F(Textured, VertexColoursOfAReceiverAreInterpolated) {
  Scene scene;
  VisualMesh mesh = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  mesh.colors = {{0, 0, 0}, {1, 0, 0}, {1, 0.5f, 0}, {0, 0.5f, 0}};  // red along x, green along y
  VisualMaterial receiver = material(Kind::shadow_receiver);
  receiver.shadow_strength = 0;
  add(scene, mesh, receiver);
  look_at(scene, {0.3, -0.2, 1}, {0.3, -0.2, 0}, 9, 9, 1e5);
  const RenderedFrame frame = picture(scene, 1);
  EXPECT_NEAR(frame.rgb[3 * 40], 0.65, 1e-4);
  EXPECT_NEAR(frame.rgb[3 * 40 + 1], 0.2, 1e-4);
  EXPECT_NEAR(frame.rgb[3 * 40 + 2], 0, 1e-6);
}

// bytes of a normal map: (n + 1) / 2; here tilted by asin(0.6) toward growing u
TEST_F(Textured, NormalMapBendsTheLight) {
  VisualMaterial m = material(Kind::diffuse);
  const Mean flat = mean(picture(floor_under_lamp(m), 64));
  Scene scene = floor_under_lamp(m);
  scene.textures.push_back(
      plain({std::uint8_t(std::lround(255 * 0.8)), 128, std::uint8_t(std::lround(255 * 0.9)), 255}));
  scene.materials[0].normal_texture = 0;
  const Mean bent = mean(picture(scene, 64));
  const double x = 2 * 204 / 255.0 - 1, y = 2 * 128 / 255.0 - 1, z = 2 * std::lround(255 * 0.9) / 255.0 - 1;
  EXPECT_NEAR(bent.value / flat.value, z / std::sqrt(x * x + y * y + z * z), 0.01);
}

// green 255 / 2: half the roughness, blue 0: no metal
TEST_F(Textured, MetallicRoughnessTextureMultipliesTheNumbers) {
  VisualMaterial m = material(Kind::metallic_roughness, {0.8f, 0.2f, 0.1f});
  m.metallic = 1;
  m.roughness = 0.8f;
  Scene textured = floor_under_lamp(m);
  textured.textures.push_back(plain({255, 128, 0, 255}));
  textured.materials[0].metallic_roughness_texture = 0;
  m.metallic = 0;
  m.roughness = 0.8f * 128 / 255;
  const RenderedFrame a = picture(textured, 64), b = picture(floor_under_lamp(m), 64);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean(a, c).value, mean(b, c).value, 0.01 * mean(b, c).value);
}

TEST_F(Textured, EmissionTextureOfACoatedSurfaceShines) {
  VisualMaterial m = material(Kind::metallic_roughness, Vec3f::Zero());
  m.emission = {2, 2, 2};
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), m);
  scene.textures.push_back(plain({255, 188, 0, 255}));
  scene.materials[0].emission_texture = 0;
  look_at(scene, {0, -0.3, 1}, {0, 0, 0}, 8, 8, 1000);
  const RenderedFrame frame = picture(scene, 16);
  EXPECT_NEAR(frame.rgb[0], 2, 1e-5);
  EXPECT_NEAR(frame.rgb[1], 2 * std::pow((188 / 255.0 + 0.055) / 1.055, 2.4), 1e-4);
  EXPECT_NEAR(frame.rgb[2], 0, 1e-6);
}

// A zero-area triangle and one of equal corners beside a good one: the picture is that of the good one, and finite.
TEST_F(Textured, TrianglesWithoutAreaChangeNothing) {
  Scene good = floor_under_lamp(material(Kind::diffuse)), bad = good;
  bad.visual_meshes[0].triangles.push_back({0, 1, 1});
  bad.visual_meshes[0].triangles.push_back({2, 2, 2});
  bad.visual_meshes[0].points.push_back({0, -1, 0});
  bad.visual_meshes[0].uvs.push_back({0, 0});
  bad.visual_meshes[0].triangles.push_back({0, 4, 1});  // on one line
  const RenderedFrame a = picture(good, 16), b = picture(bad, 16);
  EXPECT_EQ(b.dropped_samples, 0u);
  EXPECT_NEAR(mean(a).value, mean(b).value, 0.01 * mean(a).value);
  for (const float c : b.rgb) ASSERT_TRUE(std::isfinite(c));
}

}  // namespace
}  // namespace pvg::test
