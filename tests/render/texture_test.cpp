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

// Two textures of two colours each; the second coordinates swap the halves.
TEST_F(Textured, SecondCoordinatesLayOutTheTexturesThatAskForThem) {
  const auto shown = [](unsigned on_second_uvs) {
    Scene scene;
    VisualMesh mesh = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    for (const Vec2f& uv : mesh.uvs) mesh.second_uvs.emplace_back(uv.x() + 0.5f, uv.y());
    VisualMaterial m = material(Kind::metallic_roughness, Vec3f::Zero());
    m.emission = {1, 1, 1};
    m.emission_texture = 0;
    m.on_second_uvs = on_second_uvs;
    scene.textures.push_back({2, 1, {255, 0, 0, 255, 0, 255, 0, 255}});
    add(scene, mesh, m);
    look_at(scene, {-0.5, 0, 1}, {-0.5, 0, 0}, 8, 8, 1e5);  // the middle of the left half
    const RenderedFrame frame = picture(scene, 1);
    return Vec3f(frame.rgb[0], frame.rgb[1], frame.rgb[2]);
  };
  EXPECT_LT((shown(0) - Vec3f(1, 0, 0)).norm(), 1e-3);
  EXPECT_LT((shown(VisualMaterial::color_bit) - Vec3f(1, 0, 0)).norm(), 1e-3);
  EXPECT_LT((shown(VisualMaterial::emission_bit) - Vec3f(0, 1, 0)).norm(), 1e-3);
}

// Turned by a quarter, growing u of the second coordinates is growing v of the first.
TEST_F(Textured, NormalMapFollowsItsOwnCoordinates) {
  const auto brightness = [](bool is_second) {
    Scene scene = floor_under_lamp(material(Kind::diffuse));
    for (const Vec2f& uv : scene.visual_meshes[0].uvs) scene.visual_meshes[0].second_uvs.emplace_back(uv.y(), -uv.x());
    scene.textures.push_back(plain({204, 128, 230, 255}));  // tilted toward growing u
    scene.materials[0].normal_texture = 0;
    scene.materials[0].on_second_uvs = is_second ? VisualMaterial::normal_bit : 0u;
    scene.lights[0].corner.y() += 60;  // the lamp stands toward growing y = v
    return mean(picture(scene, 64)).value;
  };
  // normals (0.6, 0, 0.8) and (0, 0.6, 0.8), light from (0, 60, 100) / |.|
  const double x = 2 * 204 / 255.0 - 1, y = 2 * 128 / 255.0 - 1, z = 2 * 230 / 255.0 - 1;
  const double expected = (60 * x + 100 * z) / (60 * -y + 100 * z);
  EXPECT_NEAR(brightness(true) / brightness(false), expected, 0.02);
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
