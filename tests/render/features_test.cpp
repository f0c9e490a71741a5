// What guides denoising: colours and normals of the surfaces that scatter, by hand.
#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Features = ManyPaths;

RenderedFrame features(const Scene& scene, int samples) {
  Device device;
  RenderSettings settings;
  settings.samples = samples;
  settings.max_depth = 64;
  settings.notes_features = true;
  return Renderer(device, scene, settings).render(0, 0);
}

double mean_of(const std::vector<float>& values, std::size_t channel) {
  double sum = 0;
  for (std::size_t i = channel; i < values.size(); i += 3) sum += values[i];
  return 3 * sum / double(values.size());
}

// A pane lets (1 - R) / (1 + R) pass; what it reflects sees nothing, which has neither colour nor normal.
TEST_F(Features, WhatIsBehindGlassIsSeenThroughIt) {
  Scene scene;
  add(scene, box({-1, -1, 0}, {1, 1, 0.01f}), material(Kind::dielectric));
  add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), material(Kind::diffuse, {0.25f, 0.5f, 1}));
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 3000);
  const RenderedFrame frame = features(scene, 64);
  const double passes = 0.96 / 1.04, sigma = std::sqrt(passes * (1 - passes) / (64.0 * 64 * 64));
  EXPECT_NEAR(mean_of(frame.albedo, 0), 0.25 * passes, 4 * sigma);
  EXPECT_NEAR(mean_of(frame.albedo, 1), 0.5 * passes, 4 * sigma);
  EXPECT_NEAR(mean_of(frame.albedo, 2), passes, 4 * sigma);
  EXPECT_NEAR(mean_of(frame.mean_normal, 2), passes, 4 * sigma);
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
