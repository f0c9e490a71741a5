// What guides denoising: colours and normals of the surfaces that scatter, by hand.
#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Features = ManyPaths;

RenderedFrame features(const Scene& scene, int samples, int max_depth = 64) {
  Device device;
  RenderSettings settings;
  settings.samples = samples;
  settings.max_depth = max_depth;
  settings.notes_features = true;
  return Renderer(device, scene, settings).render(0, 0);
}

double mean_of(const std::vector<float>& values, std::size_t channel) {
  double sum = 0;
  for (std::size_t i = channel; i < values.size(); i += 3) sum += values[i];
  return 3 * sum / double(values.size());
}

// Before a pane, (1 - R) / (1 + R) of all paths pass. The others did once what has R / (1 - R) of the chance of what
// they did not do, and count by that; they see nothing, which has neither colour nor normal.
TEST_F(Features, WhatIsBehindGlassIsSeenThroughIt) {
  Scene scene;
  add(scene, box({-1, -1, 0}, {1, 1, 0.01f}), material(Kind::dielectric));
  add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), material(Kind::diffuse, {0.25f, 0.5f, 1}));
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 3000);
  const RenderedFrame frame = features(scene, 64);
  const double passes = 0.96 / 1.04, seen = passes / (passes + (1 - passes) * 0.04 / 0.96);
  EXPECT_NEAR(mean_of(frame.albedo, 0), 0.25 * seen, 2e-4);
  EXPECT_NEAR(mean_of(frame.albedo, 1), 0.5 * seen, 2e-4);
  EXPECT_NEAR(mean_of(frame.albedo, 2), seen, 2e-4);
  EXPECT_NEAR(mean_of(frame.mean_normal, 2), seen, 2e-4);
}

// Inside of a rod the light meets more faces than it has bounces. With r = R / (1 - R), a path that turned back k times
// weighs r^k; after an even number, the first at the far end, it sees the wall, else nothing.
TEST_F(Features, WhatIsBehindALongRodIsSeenThroughIt) {
  Scene scene;
  add(scene, box({-0.005f, -0.005f, -0.2f}, {0.005f, 0.005f, 0}), material(Kind::dielectric));
  add(scene, quad({-5, -5, -0.3f}, {10, 0, 0}, {0, 10, 0}), material(Kind::diffuse, Vec3f::Ones()));
  look_at(scene, {0.66, 0.66, 0.36}, {0, 0, 0}, 32, 32, 8000);
  const double outside = 0.36 / std::sqrt(2 * 0.66 * 0.66 + 0.36 * 0.36);
  const double inside = std::sqrt(1 - (1 - outside * outside) / 2.25);
  const double s = (outside - 1.5 * inside) / (outside + 1.5 * inside);
  const double p = (1.5 * outside - inside) / (1.5 * outside + inside), R = 0.5 * (s * s + p * p), r = R / (1 - R);
  const double sees = (1 - R) * (1 - R) / (1 - R * R * r * r), sees_nothing = R * r + sees * R * r;
  EXPECT_GT(R, 0.12);
  EXPECT_NEAR(mean_of(features(scene, 256, 8).albedo, 0), sees / (sees + sees_nothing), 3e-3);
}

// With 16 paths some pixels have a reflected path and some have three: a filter would take that for a texture.
TEST_F(Features, ReflectionsByChanceBringNoNoiseBehindGlass) {
  for (const bool is_thin : {false, true}) {
    Scene scene;
    VisualMaterial glass = material(Kind::dielectric);
    glass.is_thin = is_thin;
    add(scene, is_thin ? quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}) : box({-1, -1, 0}, {1, 1, 0.01f}), glass);
    add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), material(Kind::diffuse, Vec3f::Constant(0.5f)));
    look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 3000);
    for (const float color : features(scene, 16).albedo) ASSERT_NEAR(color, 0.5f, 0.03f);
  }
}

// A thin sheet, seen along it at 2.9 degrees, reflects 0.86 of the light (R = 0.75 for one face): the wall in it is
// white, what is behind it black.
TEST_F(Features, WhatIsMostlyReflectedIsNotedAsReflected) {
  Scene scene;
  VisualMaterial sheet = material(Kind::dielectric);
  sheet.is_thin = true;
  add(scene, quad({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}), sheet);
  add(scene, quad({-10, 5, 0.01f}, {20, 0, 0}, {0, 0, 20}), material(Kind::diffuse, Vec3f::Ones()));
  add(scene, quad({-10, 5, -10}, {20, 0, 0}, {0, 0, 10}), material(Kind::diffuse, Vec3f::Zero()));
  look_at(scene, {0, 0, 0.05}, {0, 1, 0}, 8, 8, 2000);
  const double reflects = 0.858, passes = 1 - reflects, seen = reflects / (reflects + passes * passes / reflects);
  EXPECT_NEAR(mean_of(features(scene, 64).albedo, 0), seen, 0.01);
}

// A mirror at 45 degrees shows the wall at its side: Schlick's reflectance 0.9 + 0.1 (1 - cos 45)^5.
TEST_F(Features, AMirrorShowsWhatItReflects) {
  Scene scene;
  VisualMaterial mirror = material(Kind::conductor, Vec3f::Constant(0.9f));
  mirror.roughness = 0;
  add(scene, quad({1, -1, -1}, {-2, 0, 2}, {0, 2, 0}), mirror);
  add(scene, quad({2, -2, -2}, {0, 4, 0}, {0, 0, 4}), material(Kind::diffuse, {0.25f, 0.5f, 1}));
  look_at(scene, {0, 0, 3}, {0, 0, 0}, 16, 16, 300);
  const RenderedFrame frame = features(scene, 4);
  const double reflects = 0.9 + 0.1 * std::pow(1 - std::sqrt(0.5), 5);
  EXPECT_NEAR(mean_of(frame.albedo, 0), 0.25 * reflects, 1e-3);
  EXPECT_NEAR(mean_of(frame.albedo, 2), reflects, 1e-3);
  EXPECT_NEAR(std::abs(mean_of(frame.mean_normal, 0)), 1, 1e-5);  // the wall's, not the mirror's
}

// A sheet seen from behind: its own normal is -z.
TEST_F(Features, NormalsAreTowardThePath) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {0, 2, 0}, {2, 0, 0}), material(Kind::diffuse));
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 8, 8, 20);
  EXPECT_NEAR(mean_of(features(scene, 4).mean_normal, 2), 1, 1e-5);
}

// An edge between black and white through the middle of a column of pixels.
TEST_F(Features, EdgesAreMixedByTheShareOfTheirSamples) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), material(Kind::diffuse, Vec3f::Zero()));
  add(scene, quad({0, -1, 0}, {1, 0, 0}, {0, 2, 0}), material(Kind::diffuse, Vec3f::Ones()));
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 9, 9, 20);
  const RenderedFrame frame = features(scene, 64);
  for (std::size_t y = 0; y < 9; ++y) {
    EXPECT_NEAR(frame.albedo[3 * (9 * y + 4)], 0.5, 0.15);
    EXPECT_EQ(frame.albedo[3 * (9 * y + 3)] + frame.albedo[3 * (9 * y + 5)], 1);
  }
}

TEST_F(Features, NotingThemLeavesThePictureAsItIs) {
  Scene scene;
  add(scene, sphere(0.5f, 12), material(Kind::dielectric));
  add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), material(Kind::diffuse));
  add_light(scene, {-0.5, -0.5, 2}, {0, 1, 0}, {1, 0, 0}, Vec3f::Ones());
  look_at(scene, {0, -2, 2}, {0, 0, 0}, 16, 16, 16);
  EXPECT_EQ(features(scene, 8).rgb, picture(scene, 8).rgb);
}

}  // namespace
}  // namespace pvg::test
