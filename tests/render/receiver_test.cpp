// The shadow receiver, C = C_tex (1 - lambda_s (1 - V)), against analytic visibilities.
#include <gtest/gtest.h>

#include <algorithm>

#include "host/pictures/picture.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/look.hpp"
#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Receiver = ManyPaths;

VisualMaterial receiver(float strength, const Vec3f& color = Vec3f::Constant(0.8f)) {
  VisualMaterial m = material(Kind::shadow_receiver, color);
  m.shadow_strength = strength;
  return m;
}

// a floor at z = 0 that does not cast shadows itself, and a light 2 m above, 0.4 m wide in x, shining down
Scene floor_and_light(float strength) {
  Scene scene;
  add(scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), receiver(strength)).casts_shadow_on_receivers = false;
  add_light(scene, {-0.2, -0.3, 2}, {0, 0.6, 0}, {0.4, 0, 0}, {5, 5, 5});
  return scene;
}

// An opaque half plane x < 0 at half the height. From the floor at x the part of the light beyond the edge is
// x_light > x + (0 - x) 2 / 1 = -x, so V rises linearly from 0 at x = -0.2 to 1 at x = 0.2.
TEST_F(Receiver, PenumbraOfAnEdgeIsLinear) {
  for (const float strength : {1.0f, 0.6f}) {
    Scene scene = floor_and_light(strength);
    add(scene, quad({-4, -4, 1}, {4, 0, 0}, {0, 8, 0}), material(Kind::diffuse));
    look_at(scene, {0, 0, 0.5}, {0, 0, 0}, 60, 40, 50);  // 0.6 m wide on the floor, a hundredth of a metre per pixel
    const RenderedFrame frame = picture(scene, 16);
    double largest_sigma = 0;
    for (int column = 0; column < 60; ++column) {
      double sum = 0, squares = 0;
      for (int row = 0; row < 40; ++row) {
        const double c = frame.rgb[3 * (60 * row + column)] / 0.8;
        sum += c / 40;
        squares += c * c / 40;
      }
      const double sigma = std::sqrt(std::max(0.0, squares - sum * sum) / 40);
      largest_sigma = std::max(largest_sigma, sigma);
      // the mean over a pixel's width; the clamps are rounded off there, by less than a hundredth
      const double x = 0.01 * (column - 29.5), V = std::clamp(0.5 + x / 0.4, 0.0, 1.0);
      EXPECT_NEAR(sum, 1 - strength * (1 - V), 4 * sigma + 0.004) << "at x = " << x;
    }
    EXPECT_LT(largest_sigma, 0.02);
  }
}

TEST_F(Receiver, WithStrengthZeroThePictureIsTheTexture) {
  Scene scene;
  Texture texture;
  texture.width = texture.height = 64;
  for (int i = 0; i < 64 * 64; ++i)
    for (const int c : {4 * (i % 64), 255 - 2 * (i / 64), 40 + i % 64 + i / 64, 255})
      texture.rgba.push_back(std::uint8_t(c));
  scene.textures.push_back(texture);
  VisualMaterial m = receiver(0, Vec3f::Ones());
  m.texture = 0;
  add(scene, quad({-0.5f, 0.5f, 0}, {1, 0, 0}, {0, -1, 0}), m).casts_shadow_on_receivers = false;  // uv (0, 0) top left
  // things that would shade, reflect and light it
  add(scene, box({-0.1f, -0.1f, 1.2f}, {0.1f, 0.1f, 1.3f}), material(Kind::diffuse));
  add_light(scene, {-0.5, -0.5, 2}, {0, 1, 0}, {1, 0, 0}, {50, 50, 50});
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 64);  // one texel per pixel
  const std::vector<std::uint8_t> bytes = encode_srgb8(picture(scene, 16).rgb, 64, 64).rgb;
  // the texture's own borders repeat, so the rim is left out
  for (int y = 1; y < 63; ++y)
    for (int x = 1; x < 63; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(bytes[3 * (64 * y + x) + c], texture.rgba[4 * (64 * y + x) + c], 1) << x << " " << y;
}

TEST_F(Receiver, BackgroundNeverShadesItself) {
  Scene scene = floor_and_light(1);
  add(scene, quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}), receiver(1)).casts_shadow_on_receivers = false;
  look_at(scene, {0, 0, 0.5}, {0, 0, 0}, 16, 16, 16);
  for (const float c : picture(scene, 4).rgb) ASSERT_NEAR(c, 0.8, 1e-5);
}

TEST_F(Receiver, WithoutLightsItIsTheTexture) {
  Scene scene = floor_and_light(1);
  scene.lights.clear();
  add(scene, quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}), material(Kind::diffuse));
  look_at(scene, {0, 0, 0.5}, {0, 0, 0}, 16, 16, 16);
  for (const float c : picture(scene, 4).rgb) ASSERT_NEAR(c, 0.8, 1e-5);
}

TEST_F(Receiver, LightThatShinesElsewhereCastsNoShadow) {
  Scene scene = floor_and_light(1);
  std::swap(scene.lights[0].edge_u, scene.lights[0].edge_v);  // now upward
  add(scene, quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}), material(Kind::diffuse));
  look_at(scene, {0, 0, 0.5}, {0, 0, 0}, 16, 16, 16);
  for (const float c : picture(scene, 4).rgb) ASSERT_NEAR(c, 0.8, 1e-5);
}

// Two lights of the same power, one covered: V is the uncovered share of the power.
TEST_F(Receiver, VisibilityIsWeightedByPower) {
  Scene scene = floor_and_light(1);
  add_light(scene, {0.8, -0.3, 2}, {0, 0.6, 0}, {0.4, 0, 0}, {15, 15, 15});
  add(scene, quad({-0.5f, -1, 1.9f}, {1, 0, 0}, {0, 2, 0}), material(Kind::diffuse));  // under the first, a quarter
  look_at(scene, {0, 0, 0.5}, {0, 0, 0}, 16, 16, 160);
  const Mean V = mean(picture(scene, 16));
  EXPECT_NEAR(V.value, 0.8 * 0.75, 4 * V.sigma + 1e-4);
}

// an even environment of radiance 1 as a picture
void add_environment(Scene& scene) {
  scene.environment_map.width = 16;
  scene.environment_map.height = 8;
  scene.environment_map.rgb.assign(16 * 8 * 3, 1.0f);
  scene.environment = Vec3f::Ones();
}

// V of a floor beside a long wall, as high as it is far away. The wall hides the share (1 - cos 45 degrees) / 2 of the
// irradiance of an even sky (view factor of a strip).
constexpr double HIDDEN_BY_WALL = 0.5 * (1 - 0.70710678);

Mean beside_a_wall(Scene scene) {
  add(scene, quad({1, -200, 0}, {0, 400, 0}, {0, 0, 1}), material(Kind::diffuse));
  look_at(scene, {0, 0, 0.5}, {0, 0, 0}, 16, 16, 1600);
  Mean V = mean(picture(scene, 64));
  EXPECT_LT(V.sigma, 0.01);
  return V;
}

// What shines from below the floor does not count.
TEST_F(Receiver, WallHidesItsShareOfTheSky) {
  Scene scene = floor_and_light(1);
  scene.lights.clear();
  add_environment(scene);
  const Mean V = beside_a_wall(scene);
  EXPECT_NEAR(V.value, 0.8 * (1 - HIDDEN_BY_WALL), 4 * V.sigma + 1e-3);
}

// Half of the light is ambient, half is that of a lamp which the wall does not hide, or of none.
TEST_F(Receiver, AmbientShareIsHiddenAsAnEvenSkyIs) {
  for (const bool has_lamp : {true, false}) {
    Scene scene = floor_and_light(1);
    if (!has_lamp) scene.lights.clear();
    scene.materials[0].ambient = 0.5f;
    const Mean V = beside_a_wall(scene);
    EXPECT_NEAR(V.value, 0.8 * (1 - 0.5 * HIDDEN_BY_WALL), 4 * V.sigma + 1e-4) << has_lamp;
  }
}

// A small lamp 2 m above that brings as much as the even sky, pi, and a plate below the lamp: half of the light is
// left.
TEST_F(Receiver, HiddenLampLeavesTheShareOfTheSky) {
  Scene scene = floor_and_light(1);
  scene.lights.clear();
  const float L = float(M_PI) * 4 / (0.02f * 0.02f);
  add_light(scene, {-0.01, -0.01, 2}, {0, 0.02, 0}, {0.02, 0, 0}, {L, L, L});
  add_environment(scene);
  add(scene, quad({-0.05f, -0.05f, 1.9f}, {0.1f, 0, 0}, {0, 0.1f, 0}), material(Kind::diffuse));
  look_at(scene, {0, 0, 0.5}, {0, 0, 0}, 16, 16, 1600);
  const Mean V = mean(picture(scene, 64));
  EXPECT_LT(V.sigma, 0.02);
  EXPECT_NEAR(V.value, 0.8 * 0.5, 4 * V.sigma + 0.008);  // the plate hides 0.001 of the sky; a ratio of few samples
}

// A pane of glass flat between floor and light: straight through it takes (1 - R) / (1 + R) exp(-sigma d). A tiny light
// straight above, so that all rays are perpendicular.
TEST_F(Receiver, GlassAttenuatesOrBlocks) {
  for (const bool transparent : {true, false}) {
    Scene scene = floor_and_light(1);
    scene.lights.clear();
    add_light(scene, {-0.01, -0.01, 2}, {0, 0.02, 0}, {0.02, 0, 0}, {5, 5, 5});
    VisualMaterial glass = material(Kind::dielectric);
    glass.absorption = {10, 0, 40};
    add(scene, box({-1, -1, 1}, {1, 1, 1.02f}), glass);
    look_at(scene, {0, 0, 0.5}, {0, 0, 0}, 8, 8, 800);
    const RenderedFrame frame = picture(scene, 4, transparent);
    const double R = 0.04, T = transparent ? (1 - R) / (1 + R) : 0;
    EXPECT_NEAR(frame.rgb[0], 0.8 * T * std::exp(-0.2), 1e-4);
    EXPECT_NEAR(frame.rgb[1], 0.8 * T, 1e-4);
    EXPECT_NEAR(frame.rgb[2], 0.8 * T * std::exp(-0.8), 1e-4);
  }
}

}  // namespace
}  // namespace pvg::test
