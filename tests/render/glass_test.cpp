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
  const Mean with = mean(picture(scene, 64));
  EXPECT_NEAR(with.value, without.value, 4 * std::hypot(with.sigma, without.sigma) + 1e-3);
  EXPECT_LT(without.value, 0.7);
}

}  // namespace
}  // namespace pvg::test
