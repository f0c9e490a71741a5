// Spots: a ball of light that shines within a cone.
#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Spot = ManyPaths;

// radiance of a white floor straight below a small ball at 1 m whose axis is tilted by this angle
Mean floor_below(double tilt, double inner_angle, double outer_angle) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), material(VisualMaterial::Kind::diffuse));
  SphereLight light;
  light.name = "spot";
  light.center = {0, 0, 1};
  light.radius = 1e-3;
  light.radiance = Vec3f::Constant(1e6f);
  light.direction = {std::sin(tilt), 0, -std::cos(tilt)};
  light.inner_angle = inner_angle;
  light.outer_angle = outer_angle;
  scene.sphere_lights = {light};
  look_at(scene, {0, -0.3, 0.5}, {0, 0, 0}, 8, 8, 1e4);
  return mean(picture(scene, 16));
}

TEST_F(Spot, ShinesWithinItsInnerAngleFallsOffAndEnds) {
  // E = pi r^2 L / d^2, a white surface shows E / pi
  EXPECT_NEAR(floor_below(0, 4, 4).value, 1, 0.002);
  EXPECT_NEAR(floor_below(0.1, 0.2, 0.4).value, 1, 0.005);
  const double share = (std::cos(0.3) - std::cos(0.4)) / (std::cos(0.2) - std::cos(0.4));  // KHR_lights_punctual
  EXPECT_NEAR(floor_below(0.3, 0.2, 0.4).value, share * share, 0.02 * share * share);
  EXPECT_NEAR(floor_below(0.5, 0.2, 0.4).value, 0, 1e-6);
}

}  // namespace
}  // namespace pvg::test
