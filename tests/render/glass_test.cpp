// Glass against slabs computed by hand.
#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Glass = ManyPaths;

// a pane of 1 cm, seen perpendicularly
Scene pane(const Vec3f& absorption) {
  Scene scene;
  VisualMaterial glass = material(Kind::dielectric);
  glass.absorption = absorption;
  add(scene, box({-1, -1, 0}, {1, 1, 0.01f}), glass);
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 3000);
  return scene;
}

// between the faces the light goes to and fro, a = exp(-sigma d) each time:
//   T = (1 - R)^2 a (1 + (R a)^2 + ...) = (1 - R)^2 a / (1 - (R a)^2)
TEST_F(Glass, PaneTransmitsWhatFresnelAndBeerLeave) {
  Scene scene = pane({0, 50, 200});
  VisualMaterial lamp = material(Kind::emissive);
  lamp.emission = Vec3f::Ones();
  add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), lamp);
  const RenderedFrame frame = picture(scene, 64);
  const double R = 0.04;
  for (int c = 0; c < 3; ++c) {
    const double a = std::exp(-0.01 * (c == 0 ? 0 : c == 1 ? 50 : 200));
    const Mean T = mean(frame, c);
    EXPECT_NEAR(T.value, (1 - R) * (1 - R) * a / (1 - R * R * a * a), 4 * T.sigma + 1e-4);
    EXPECT_LT(T.sigma, 1e-3);
  }
}

// Panes without reflection: every path crosses their four faces and brings the same. None may end by chance for the
// little that it lost.
TEST_F(Glass, PaleGlassBringsNoNoise) {
  Scene scene = pane(Vec3f::Constant(5));
  scene.materials[0].index_of_refraction = 1.0001f;
  add(scene, box({-1, -1, -0.5f}, {1, 1, -0.49f}), scene.materials[0]);
  VisualMaterial lamp = material(Kind::emissive);
  lamp.emission = Vec3f::Ones();
  add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), lamp);
  for (const float value : picture(scene, 4).rgb) ASSERT_NEAR(value, std::exp(-0.1), 1e-4);
}

// seen from both sides the series is R + (1 - R)^2 a / (1 - R a)
TEST_F(Glass, PaneInAFurnaceLosesWhatItAbsorbs) {
  Scene scene = pane({0, 50, 200});
  scene.environment = Vec3f::Ones();
  const RenderedFrame frame = picture(scene, 64);
  const double R = 0.04;
  for (int c = 0; c < 3; ++c) {
    const double a = std::exp(-0.01 * (c == 0 ? 0 : c == 1 ? 50 : 200));
    const Mean L = mean(frame, c);
    EXPECT_NEAR(L.value, R + (1 - R) * (1 - R) * a / (1 - R * a), 4 * L.sigma + 1e-4);
  }
}

// A rod of 1 cm x 1 cm x 50 cm, seen from 40 degrees beside its axis. Inside the light goes 50 cm / cos t, sin t = sin
// 40 / 1.5, and meets the sides some 30 times on its way to the other end, where R of it turns back: the series of the
// pane, whatever the bounces are. It comes out at one of four angles of the same cosine.
TEST_F(Glass, RodLeadsLightOverMoreFacesThanBounces) {
  Scene scene;
  VisualMaterial glass = material(Kind::dielectric);
  glass.absorption = {0, 0.5f, 2};
  add(scene, box({-0.005f, -0.005f, -0.5f}, {0.005f, 0.005f, 0}), glass);
  scene.environment = Vec3f::Ones();
  const double angle = 40 * M_PI / 180, side = std::sin(angle) * std::sqrt(0.5), outside = std::cos(angle);
  look_at(scene, {side, side, outside}, {0, 0, 0}, 32, 32, 8000);
  const double inside = std::sqrt(1 - std::pow(std::sin(angle) / 1.5, 2));
  const double s = (outside - 1.5 * inside) / (outside + 1.5 * inside);
  const double p = (1.5 * outside - inside) / (1.5 * outside + inside), R = 0.5 * (s * s + p * p);
  const RenderedFrame frame = picture(scene, 64, true, 8);
  for (int c = 0; c < 3; ++c) {
    const double a = std::exp(-(c == 0 ? 0 : c == 1 ? 0.5 : 2) * 0.5 / inside);
    const Mean L = mean(frame, c);
    EXPECT_NEAR(L.value, R + (1 - R) * (1 - R) * a / (1 - R * a), 4 * L.sigma + 1e-3);
    EXPECT_LT(L.sigma, 2e-3);
  }
}

// A rod in water, which takes red from what its sides do not reflect: glass to water reflects all from 62 degrees on,
// glass to air from 42. Few bounces or many, the picture is the same.
TEST_F(Glass, RodInWaterLosesLightThroughItsSides) {
  Scene scene;
  VisualMaterial glass = material(Kind::dielectric), water = material(Kind::dielectric);
  glass.priority = 1;
  water.index_of_refraction = 1.33f;
  water.absorption = {40, 0, 0};
  add(scene, box({-0.005f, -0.005f, -0.1f}, {0.005f, 0.005f, -0.01f}), glass);
  add(scene, box({-1, -1, -0.2f}, {1, 1, 0}), water);
  scene.environment = Vec3f::Ones();
  look_at(scene, {0.85, 0.1, 0.5}, {0, 0, -0.01}, 32, 32, 3000);
  const Mean many = mean(picture(scene, 256), 0), few = mean(picture(scene, 256, true, 4), 0);
  EXPECT_NEAR(few.value, many.value, 4 * std::hypot(few.sigma, many.sigma));
  EXPECT_GT(few.value, 20 * few.sigma);
}

// A diffuse floor lit through a pane: straight shadow rays against true refraction. For a flat pane they agree but for
// the small sideways shift, which the wide light forgives.
TEST_F(Glass, StraightShadowsAgreeWithRefractedPathsUnderAFlatPane) {
  Mean radiance[2];
  for (const bool transparent : {false, true}) {
    Scene scene;
    add(scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), material(Kind::diffuse, Vec3f::Constant(0.5f)));
    VisualMaterial glass = material(Kind::dielectric);
    glass.absorption = {5, 20, 40};
    add(scene, box({-3, -3, 0.5f}, {3, 3, 0.51f}), glass);
    add_light(scene, {-0.6, -0.6, 1}, {0, 1.2, 0}, {1.2, 0, 0}, {4, 4, 4});
    look_at(scene, {0, -0.3, 0.3}, {0, 0, 0}, 64, 64, 2000);
    radiance[transparent] = mean(picture(scene, 64, transparent), 1);
  }
  EXPECT_GT(radiance[0].value, 0.2);
  // light that the floor throws back to the pane and gets again is the same in both
  EXPECT_NEAR(radiance[1].value, radiance[0].value,
              0.01 * radiance[0].value + 4 * std::hypot(radiance[0].sigma, radiance[1].sigma));
}

// glass in glass: a ball of the same index inside a block of glass cannot be seen, and the stack of media comes out
// empty
TEST_F(Glass, BallOfTheSameGlassInsideABlockIsInvisible) {
  Scene scene;
  scene.environment = Vec3f::Ones();
  VisualMaterial glass = material(Kind::dielectric);
  glass.absorption = Vec3f::Constant(3);
  add(scene, box({-1, -1, -0.1f}, {1, 1, 0.1f}), glass);
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 3000);
  const Mean without = mean(picture(scene, 64));
  add(scene, sphere(0.05f, 64), glass);
  for (const int max_depth : {64, 2}) {
    const Mean with = mean(picture(scene, 64, true, max_depth));
    EXPECT_NEAR(with.value, without.value, 4 * std::hypot(with.sigma, without.sigma) + 1e-3);
  }
  EXPECT_LT(without.value, 0.7);
}

// what is inside of glass and is none is met by the next bounce
TEST_F(Glass, LampInsideABlockIsSeenWhateverTheBounces) {
  Scene scene;
  VisualMaterial glass = material(Kind::dielectric), lamp = material(Kind::emissive);
  glass.absorption = Vec3f::Constant(3);
  lamp.emission = Vec3f::Ones();
  add(scene, box({-1, -1, -0.1f}, {1, 1, 0.1f}), glass);
  add(scene, quad({-1, -1, -0.05f}, {2, 0, 0}, {0, 2, 0}), lamp);
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 3000);
  const double R = 0.04, a = std::exp(-3 * 0.15);
  for (const int max_depth : {64, 2}) {
    const Mean L = mean(picture(scene, 64, true, max_depth));
    // what the face reflects down meets the lamp, which reflects nothing; radiance in glass is n^2 of that in air
    EXPECT_NEAR(L.value, (1 - R) * a, 4 * L.sigma + 1e-4);
  }
}

// water (1.33) that reaches a little into glass (1.5) of higher priority: one interface from glass to water, no gap of
// air and no water in the glass. Seen from above through both in a furnace, only absorption takes light away.
TEST_F(Glass, WaterThatOverlapsItsBeakerLeavesNoGap) {
  const double n_glass = 1.5, n_water = 1.33;
  Scene scene;
  scene.environment = Vec3f::Zero();
  VisualMaterial glass = material(Kind::dielectric), water = material(Kind::dielectric);
  glass.index_of_refraction = float(n_glass);
  glass.priority = 1;
  water.index_of_refraction = float(n_water);
  water.absorption = {0, 20, 60};
  add(scene, box({-1, -1, 0}, {1, 1, 0.01f}), glass);
  add(scene, box({-1.1f, -1.1f, 0.008f}, {1.1f, 1.1f, 0.05f}), water);  // 2 mm inside the glass, 40 mm above it
  VisualMaterial lamp = material(Kind::emissive);
  lamp.emission = Vec3f::Ones();
  add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), lamp);
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 3000);
  const RenderedFrame frames[] = {picture(scene, 256, false, 64), picture(scene, 256, false, 4)};
  const auto R = [](double a, double b) { return (a - b) * (a - b) / ((a + b) * (a + b)); };
  for (int c = 0; c < 3; ++c) {
    const double a = std::exp(-0.04 * (c == 0 ? 0 : c == 1 ? 20 : 60));
    // layers from above: air-water, 40 mm of water, water-glass, glass-air; light goes to and fro between all of them
    struct Layer {
      double T_down, T_up, R_above, R_below;
    };
    const auto join = [](const Layer& p, const Layer& q, double way) {
      const double loop = 1 / (1 - p.R_below * q.R_above * way * way);
      return Layer{p.T_down * q.T_down * way * loop, p.T_up * q.T_up * way * loop,
                   p.R_above + p.T_down * p.T_up * q.R_above * way * way * loop,
                   q.R_below + q.T_down * q.T_up * p.R_below * way * way * loop};
    };
    const auto face = [&](double x, double y) { return Layer{1 - R(x, y), 1 - R(x, y), R(x, y), R(x, y)}; };
    const Layer all = join(join(face(1, n_water), face(n_water, n_glass), a), face(n_glass, 1), 1);
    for (const RenderedFrame& frame : frames) {
      const Mean T = mean(frame, c);
      EXPECT_LT(T.sigma, 2e-3);
      EXPECT_NEAR(T.value, all.T_up, 4 * T.sigma + 1e-4) << "channel " << c;
    }
  }
}

// a camera in the middle of a ball of glass sees what is around it through 5 cm of glass, once, but for reflections
TEST_F(Glass, CameraInsideGlassSeesThroughIt) {
  Scene scene;
  scene.environment = Vec3f::Ones();
  VisualMaterial glass = material(Kind::dielectric);
  glass.absorption = {0, 10, 30};
  add(scene, sphere(0.05f, 96), glass);
  look_at(scene, {0, 0, 0}, {0, 1, 0}, 16, 16, 200);
  const RenderedFrame frame = picture(scene, 256);
  const double R = 0.04;
  for (int c = 0; c < 3; ++c) {
    const double a = std::exp(-0.05 * (c == 0 ? 0 : c == 1 ? 10 : 30));
    const Mean L = mean(frame, c);
    // what is reflected comes back through the centre, twice as far
    EXPECT_NEAR(L.value, (1 - R) * a / (1 - R * a * a), 4 * L.sigma + 2e-3);
  }
}

TEST_F(Glass, ThinSheetPassesItsTintStraightOn) {
  Scene scene;
  VisualMaterial sheet = material(Kind::dielectric, {1, 0.5f, 0.25f});
  sheet.is_thin = true;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), sheet);
  VisualMaterial lamp = material(Kind::emissive);
  lamp.emission = Vec3f::Ones();
  add(scene, quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), lamp);
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 64, 64, 3000);
  const RenderedFrame frame = picture(scene, 64);
  const double T = 1 - 2 * 0.04 / 1.04;
  for (int c = 0; c < 3; ++c) {
    const Mean measured = mean(frame, c);
    EXPECT_NEAR(measured.value, T * std::pow(0.5, c), 4 * measured.sigma + 1e-4);
  }
}

// the rougher a ball of glass, the more is lost between facets, but nothing is made
TEST_F(Glass, RoughGlassMakesNoLight) {
  double last = 1;
  for (const float roughness : {0.1f, 0.4f, 0.7f}) {
    Scene scene;
    scene.environment = Vec3f::Ones();
    VisualMaterial glass = material(Kind::dielectric);
    glass.roughness = roughness;
    add(scene, sphere(1, 48), glass);
    look_at(scene, {0, -3, 0.4}, {0, 0, 0}, 24, 24, 27);
    const Mean L = mean(picture(scene, 64, true, 64));
    EXPECT_LE(L.value, last + 4 * L.sigma);
    EXPECT_GT(L.value, 0.6);
    last = L.value;
  }
  EXPECT_LT(last, 0.99);
}

// lit by a lamp: light samples through the surface and those of the material agree with the material's own alone, which
// an even sky of the same light asks for
TEST_F(Glass, FrostedPaneLitByALightAgreesWithAShiningSky) {
  Scene scene[2];
  for (int k = 0; k < 2; ++k) {
    VisualMaterial glass = material(Kind::dielectric);
    glass.roughness = 0.6f;
    add(scene[k], box({-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0.01f}), glass);
    look_at(scene[k], {0, -0.4, 1}, {0, 0, 0}, 24, 24, 300);
  }
  // a lamp so large and near that it is all of the lower half space, but for 1 in 10 000
  add_light(scene[0], {-50, -50, -0.5}, {100, 0, 0}, {0, 100, 0}, Vec3f::Ones());
  EnvironmentMap& map = scene[1].environment_map;
  map.width = 4;
  map.height = 512;
  for (int i = 0; i < 512 * 4 * 3; ++i) map.rgb.push_back(i >= 256 * 4 * 3 ? 1.0f : 0.0f);
  scene[1].environment = Vec3f::Ones();
  const Mean lamp = mean(picture(scene[0], 128)), sky = mean(picture(scene[1], 128));
  EXPECT_GT(sky.value, 0.3);
  EXPECT_NEAR(lamp.value, sky.value, 0.01 * sky.value + 4 * std::hypot(lamp.sigma, sky.sigma));
}

}  // namespace
}  // namespace pvg::test
