// Our own filter and Open Image Denoise bring a picture of few samples nearer to one of many, on scenes of every kind
// of surface; the former leaves alone what has no noise.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "host/render/image_denoise.hpp"
#include "host/render/picture_finish.hpp"
#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
// our own filter, also on machines that have the library
struct Denoise : ManyPaths {
  void SetUp() override {
    setenv("PVG_DENOISER", "none", 1);
    ManyPaths::SetUp();
  }
  void TearDown() override { unsetenv("PVG_DENOISER"); }
};

struct LibraryDenoise : ManyPaths {
  void SetUp() override {
    ManyPaths::SetUp();
    if (!IsSkipped() && !ImageDenoise::find(false))
      GTEST_SKIP() << "Open Image Denoise is not here; scripts/install_denoiser.sh";
  }
};

RenderedFrame shot(const Scene& scene, int samples, bool denoises) {
  Device device;
  RenderSettings settings;
  settings.samples = samples;
  settings.denoises = denoises;
  settings.seed = samples > 100 ? 1 : 0;
  return Renderer(device, scene, settings).render(0, 0);
}

double error(const RenderedFrame& a, const RenderedFrame& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    // as it is shown: what is brighter than white does not count
    const double d = std::min(a.rgb[i], 1.0f) - std::min(truth.rgb[i], 1.0f);
    sum += d * d;
  }
  return std::sqrt(sum / double(a.rgb.size()));
}

// A checked floor under a shadow, a ball of that kind or a floor that receives shadows. check: of a square [texels]
Scene room(Kind kind, int check = 8) {
  Scene scene;
  Texture checks{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) {
    const std::uint8_t v = (i % 64 / check + i / 64 / check) % 2 ? 200 : 90;
    checks.rgba.insert(checks.rgba.end(), {v, v, std::uint8_t(v / 2), 255});
  }
  scene.textures.push_back(checks);
  VisualMaterial floor = material(kind == Kind::shadow_receiver ? kind : Kind::diffuse);
  floor.texture = 0;
  add(scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), floor).casts_shadow_on_receivers = kind != Kind::shadow_receiver;
  VisualMaterial m = material(kind == Kind::shadow_receiver ? Kind::diffuse : kind, {0.7f, 0.5f, 0.3f});
  m.roughness = kind == Kind::dielectric ? 0 : 0.4f;
  m.sheen = Vec3f::Constant(0.4f);
  add(scene, sphere(0.4f, 24), m, {0, 0, 0.4});
  add_light(scene, {-1.5, -0.5, 2}, {0, 0.6, 0}, {0.6, 0, 0}, Vec3f::Constant(15));
  scene.environment = Vec3f::Constant(0.1f);
  look_at(scene, {0, -2.4, 1.2}, {0, 0, 0.3}, 64, 48, 60);
  return scene;
}

// the built-in filter is guided by the ground truth, whoever asks for it
TEST_F(Denoise, PicturesAreTheSameWithoutGroundTruth) {
  const Scene scene = room(Kind::diffuse);
  Device device;
  for (const bool denoises : {false, true}) {
    RenderSettings settings;
    settings.samples = 2;
    settings.denoises = denoises;
    const RenderedFrame with = Renderer(device, scene, settings).render(0, 0);
    settings.finds_truth = false;
    const RenderedFrame without = Renderer(device, scene, settings).render(0, 0);
    EXPECT_EQ(without.rgb, with.rgb);
    EXPECT_EQ(with.depth.size(), with.rgb.size() / 3);
    EXPECT_TRUE(without.depth.empty() && without.distance.empty() && without.instance.empty() &&
                without.normal.empty());
  }
}

TEST_F(Denoise, BringsEverySceneNearerToTheTruth) {
  for (const Kind kind : {Kind::diffuse, Kind::conductor, Kind::dielectric, Kind::shadow_receiver,
                          Kind::metallic_roughness, Kind::cloth}) {
    const Scene scene = room(kind);
    const RenderedFrame truth = shot(scene, 256, false);
    const double noisy = error(shot(scene, 8, false), truth), filtered = error(shot(scene, 8, true), truth);
    EXPECT_LT(filtered, noisy) << "kind " << int(kind);
    std::printf("kind %d: error %.4f without the filter, %.4f with it\n", int(kind), noisy, filtered);
  }
}

// Squares about three pixels wide: the light on them is as smooth as elsewhere.
TEST_F(Denoise, AFineTextureIsNoEdge) {
  for (const auto& [kind, share] : {std::pair(Kind::diffuse, 0.93), std::pair(Kind::shadow_receiver, 0.87)}) {
    const Scene scene = room(kind, 2);
    const RenderedFrame truth = shot(scene, 256, false);
    const double noisy = error(shot(scene, 8, false), truth), filtered = error(shot(scene, 8, true), truth);
    EXPECT_LT(filtered, share * noisy) << "kind " << int(kind);
    std::printf("kind %d: error %.4f without the filter, %.4f with it\n", int(kind), noisy, filtered);
  }
}

TEST_F(Denoise, WhatHasNoNoiseStays) {
  Scene scene = room(Kind::shadow_receiver);
  scene.materials[0].shadow_strength = 0;
  scene.visuals.pop_back();
  scene.lights.clear();
  const RenderedFrame plain = shot(scene, 4, false), filtered = shot(scene, 4, true);
  for (std::size_t i = 0; i < plain.rgb.size(); ++i) {
    // within a texel's width light and albedo are not quite of the same place
    ASSERT_NEAR(plain.rgb[i], filtered.rgb[i], 0.15);
  }
  EXPECT_LT(error(filtered, plain), 0.02);
}

TEST_F(LibraryDenoise, BringsEverySceneNearerToTheTruth) {
  for (const Kind kind : {Kind::diffuse, Kind::conductor, Kind::dielectric, Kind::shadow_receiver}) {
    const Scene scene = room(kind);
    const RenderedFrame truth = shot(scene, 256, false);
    const double noisy = error(shot(scene, 8, false), truth), filtered = error(shot(scene, 8, true), truth);
    EXPECT_LT(filtered, noisy) << "kind " << int(kind);
    std::printf("kind %d: error %.4f without it, %.4f with it\n", int(kind), noisy, filtered);
  }
}

// as the stages of an episode do it: a picture is finished when the next one has been traced
TEST_F(LibraryDenoise, FilteredLaterIsTheSamePicture) {
  Scene scene = room(Kind::diffuse);
  scene.cameras[0].exposure = 1.7;
  scene.cameras[0].full_well = 2000;
  Device device;
  Renderer renderer(device, scene, {.samples = 4, .denoises = true});
  const RenderedFrame first = renderer.render(0, 1), second = renderer.render(0, 2);
  const auto still = [&](double) { return initial_state(scene); };
  RenderedFrame traced_first = renderer.trace(0, 1, still, 0), traced_second = renderer.trace(0, 2, still, 0);
  EXPECT_NE(traced_first.rgb, first.rgb);
  (*renderer.finish())(traced_first, 0, 1);
  (*renderer.finish())(traced_second, 0, 2);
  EXPECT_EQ(traced_first.rgb, first.rgb);
  EXPECT_EQ(traced_second.rgb, second.rgb);
  // without the sensor's noise the exposure is a factor of what is filtered
  scene.cameras[0].full_well = 0;
  Renderer exposed(device, scene, {.samples = 4, .denoises = true});
  scene.cameras[0].exposure = 1;
  Renderer as_it_is(device, scene, {.samples = 4, .denoises = true});
  const RenderedFrame bright = exposed.render(0, 1), dim = as_it_is.render(0, 1);
  ASSERT_EQ(bright.rgb.size(), dim.rgb.size());
  for (std::size_t i = 0; i < dim.rgb.size(); ++i) ASSERT_EQ(bright.rgb[i], 1.7f * dim.rgb[i]);
}

// A grey wall with noise of 10 %, of any sides: borders and corners are as grey as the middle.
TEST_F(LibraryDenoise, LeavesBordersAndCornersAsTheyAre) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(1, 0.1f);
  for (const auto& [width, height] : {std::pair{640u, 360u}, std::pair{100u, 75u}, std::pair{33u, 21u}}) {
    NoisyPicture picture{width, height, {}, {}, {}};
    for (std::uint32_t i = 0; i < width * height; ++i) {
      const float v = 0.25f * noise(random);
      picture.rgb.insert(picture.rgb.end(), {v, v, v});
      picture.color.insert(picture.color.end(), {0.5f, 0.5f, 0.5f});
      picture.normal.insert(picture.normal.end(), {0, 0, 1});
    }
    const std::vector<float> filtered = ImageDenoise::find(false)->filter(picture);
    ASSERT_EQ(filtered.size(), picture.rgb.size());
    for (std::size_t i = 0; i < filtered.size(); ++i)
      ASSERT_NEAR(filtered[i], 0.25f, 0.03f) << width << " x " << height << ", pixel " << i / 3;
  }
}

TEST_F(LibraryDenoise, GivesTheSameBitsAgain) {
  const Scene scene = room(Kind::dielectric);
  EXPECT_EQ(shot(scene, 4, true).rgb, shot(scene, 4, true).rgb);
}

TEST_F(LibraryDenoise, IsNamedWithItsVersionAndWithoutItOurOwnFilterIs) {
  Device device;
  EXPECT_TRUE(denoiser_name(device).starts_with("Open Image Denoise 2.")) << denoiser_name(device);
  setenv("PVG_DENOISER", "none", 1);
  EXPECT_EQ(denoiser_name(device), OWN_DENOISER);
  unsetenv("PVG_DENOISER");
}

}  // namespace
}  // namespace pvg::test
