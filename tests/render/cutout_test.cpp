// Alpha masks and blending: what is seen through them, and what light they let pass.
#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Mode = VisualMaterial::AlphaMode;
using Cutout = ManyPaths;

// shows its colour whatever shines on it
VisualMaterial plain_color(const Vec3f& color) {
  VisualMaterial m = material(Kind::shadow_receiver, color);
  m.shadow_strength = 0;
  return m;
}

// there in the left half of its texture (u < 1/2), a hole in the right half
VisualMaterial half_open(Scene& scene, VisualMaterial m) {
  m.alpha_mode = Mode::mask;
  m.texture = int(scene.textures.size());
  scene.textures.push_back({2, 1, {255, 255, 255, 255, 255, 255, 255, 0}});
  return m;
}

VisualMaterial blended(VisualMaterial m, float opacity) {
  m.alpha_mode = Mode::blend;
  m.opacity = opacity;
  return m;
}

// straight down on the square [-1, 1]^2 at z, all of it in the picture
void look_down(Scene& scene, double from, double onto, int pixels) {
  look_at(scene, {0, 0, from}, {0, 0, onto}, pixels, pixels, pixels / 2.0 * (from - onto));
}

// mean over the columns left of the middle, or right of it
double half_mean(const RenderedFrame& frame, bool is_right) {
  double sum = 0;
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width / 2; ++x)
      sum += frame.rgb[3 * std::size_t(y * frame.width + x + (is_right ? frame.width / 2 : 0))];
  return sum / (frame.height * frame.width / 2);
}

TEST_F(Cutout, HolesOfAMaskAreSeenThrough) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), half_open(scene, plain_color({0.2f, 0, 0})));
  add(scene, quad({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}), plain_color({0.7f, 0, 0}));
  look_down(scene, 4, 0, 8);
  const RenderedFrame frame = picture(scene, 4);
  for (std::size_t i = 0; i < 64; ++i) {
    const bool is_hole = i % 8 >= 4;
    EXPECT_NEAR(frame.rgb[3 * i], is_hole ? 0.7 : 0.2, 1e-5) << i;
    EXPECT_EQ(frame.instance[i], is_hole ? 2u : 1u) << i;
    EXPECT_NEAR(frame.depth[i], is_hole ? 5 : 4, 1e-4) << i;
  }
}

// 20 layers of nothing between the eye and the wall, and no bounce to spend on them
TEST_F(Cutout, HolesTakeNoBounces) {
  Scene scene;
  const VisualMaterial open = blended(material(Kind::diffuse), 0);
  for (int i = 0; i < 20; ++i) add(scene, quad({-2, -2, 0.1f * float(i)}, {4, 0, 0}, {0, 4, 0}), open);
  add(scene, quad({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}), plain_color({0.7f, 0, 0}));
  look_down(scene, 4, 0, 4);
  EXPECT_NEAR(mean(picture(scene, 1, true, 1)).value, 0.7, 1e-5);
}

TEST_F(Cutout, WhatBlendsIsSeenByItsShare) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), blended(plain_color({0.2f, 0, 0}), 0.25f));
  add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), blended(plain_color({0.4f, 0, 0}), 0.5f));
  add(scene, quad({-2, -2, -2}, {4, 0, 0}, {0, 4, 0}), plain_color({0.8f, 0, 0}));
  look_down(scene, 4, -1, 16);
  const Mean seen = mean(picture(scene, 64));
  EXPECT_NEAR(seen.value, 0.25 * 0.2 + 0.75 * (0.5 * 0.4 + 0.5 * 0.8), 4 * seen.sigma);
}

// a floor under a far lamp, so small that shadows are sharp, between them a sheet that the camera is below of
Scene floor_under_sheet(const VisualMaterial& floor) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), floor);
  add_light(scene, {-5e-4, -5e-4, 100}, {0, 1e-3, 0}, {1e-3, 0, 0}, Vec3f::Constant(1e10f));
  look_down(scene, 1, 0, 16);
  return scene;
}

void add_sheet(Scene& scene, const VisualMaterial& m) { add(scene, quad({-1, -1, 1.2f}, {2, 0, 0}, {0, 2, 0}), m); }

TEST_F(Cutout, LightPassesTheHolesOfAMaskAlone) {
  for (const bool transparent_shadows : {true, false})
    for (const bool is_receiver : {false, true}) {
      const VisualMaterial floor = material(is_receiver ? Kind::shadow_receiver : Kind::diffuse, {0.5f, 0.5f, 0.5f});
      const Scene open = floor_under_sheet(floor);
      Scene scene = open;
      add_sheet(scene, half_open(scene, material(Kind::diffuse, Vec3f::Zero())));
      const RenderedFrame lit = picture(open, 16, transparent_shadows),
                          half_lit = picture(scene, 16, transparent_shadows);
      EXPECT_NEAR(half_mean(half_lit, false), 0, 1e-4);
      EXPECT_NEAR(half_mean(half_lit, true), half_mean(lit, true), 0.02 * half_mean(lit, true));
    }
}

TEST_F(Cutout, WhatBlendsTakesItsShareOfTheLight) {
  const Scene open = floor_under_sheet(material(Kind::diffuse));
  Scene scene = open;
  add_sheet(scene, blended(material(Kind::diffuse, Vec3f::Zero()), 0.25f));
  EXPECT_NEAR(mean(picture(scene, 64)).value / mean(picture(open, 64)).value, 0.75, 0.01);
}

// A lamp with holes lights a floor as one of half the size does, by light samples and by paths alike.
TEST_F(Cutout, ALampWithHolesIsSmaller) {
  VisualMaterial lamp = material(Kind::metallic_roughness, Vec3f::Zero());
  lamp.emission = {3, 3, 3};
  Scene cut, half;
  for (Scene* scene : {&cut, &half}) add(*scene, quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}), material(Kind::diffuse));
  add(cut, quad({-1, -1, 2}, {2, 0, 0}, {0, 2, 0}), half_open(cut, lamp));
  add(half, quad({-1, -1, 2}, {1, 0, 0}, {0, 2, 0}), lamp);
  for (Scene* scene : {&cut, &half}) look_down(*scene, 1.5, 0, 16);
  const Mean a = mean(picture(cut, 256)), b = mean(picture(half, 256));
  EXPECT_GT(b.value, 0.1);
  // pixels differ by what they see, so their spread says too much: it is the same picture for both
  EXPECT_NEAR(a.value, b.value, 0.01 * b.value);
}

TEST_F(Cutout, AMaskOfFullAlphaIsNotThere) {
  Scene scene;
  VisualMaterial whole = material(Kind::diffuse), cut = whole;
  whole.alpha_mode = cut.alpha_mode = Mode::mask;
  cut.opacity = 0.4f;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), cut);
  add(scene, quad({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}), whole);
  look_down(scene, 4, 0, 4);
  const RenderedFrame frame = picture(scene, 1);
  for (const std::uint32_t instance : frame.instance) EXPECT_EQ(instance, 2u);
}

}  // namespace
}  // namespace pvg::test
