// Light that glass and mirrors throw, by light paths and camera paths together: against Lambert's formula for a
// mirrored lamp, and against camera paths alone, which a camera with a rolling shutter takes.
#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using LightTracing = ManyPaths;

RenderedFrame caustics(Device& device, const Scene& scene, int samples, std::uint64_t seed, int max_depth = 8) {
  RenderSettings settings;
  settings.samples = samples;
  settings.max_depth = max_depth;
  settings.seed = seed;
  settings.transparent_shadows = false;
  Renderer renderer(device, scene, settings);
  if (scene.cameras[0].exposure_time == 0) return renderer.render(0, 0);
  return renderer.render(
      0, 0, [&](double) { return initial_state(scene); }, 0);
}

// its pictures are of camera paths alone
Scene without_light_paths(Scene scene) {
  for (Camera& camera : scene.cameras) camera.row_time = 1e-9;
  return scene;
}

// of one colour over several seeds, sigma from their spread
Mean mean_of_seeds(Device& device, const Scene& scene, int samples, int n_seeds, int max_depth) {
  double sum = 0, squares = 0;
  for (int seed = 1; seed <= n_seeds; ++seed) {
    const double x = mean(caustics(device, scene, samples, std::uint64_t(seed), max_depth), 1).value;
    sum += x;
    squares += x * x;
  }
  const double value = sum / n_seeds;
  return {value, std::sqrt(std::max(0.0, squares / n_seeds - value * value) / (n_seeds - 1))};
}

void expect_same_light(const Scene& scene, int max_depth = 8, int samples = 512) {
  Device device;
  const Mean with = mean_of_seeds(device, scene, samples, 8, max_depth);
  const Mean without = mean_of_seeds(device, without_light_paths(scene), samples, 8, max_depth);
  EXPECT_GT(without.value, 0.01);
  EXPECT_LT(without.sigma, 0.015 * without.value);
  EXPECT_LT(with.sigma, 0.015 * with.value);
  EXPECT_NEAR(with.value, without.value, 4 * std::hypot(with.sigma, without.sigma) + 2e-4 * without.value);
}

// A floor and a wall of which all light comes through a pane of glass at the end of a black shaft, a ball of glass with
// smooth normals between. The shaft keeps light paths together, so that they carry most of the weight.
Scene below_a_pane() {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), material(Kind::diffuse, {0.8f, 0.6f, 0.4f}));
  VisualMaterial wall = material(Kind::metallic_roughness, {0.7f, 0.7f, 0.7f});
  wall.roughness = 0.5f;
  add(scene, quad({-1, 1, 0}, {2, 0, 0}, {0, 0, 1}), wall);
  add(scene, box({-0.41f, -0.41f, 0.8f}, {0.41f, 0.41f, 0.82f}), material(Kind::dielectric));
  VisualMaterial glass = material(Kind::dielectric);
  glass.absorption = Vec3f::Constant(0.5f);
  add(scene, sphere(0.25f, 24), glass, Vec3(0.1, 0.2, 0.4));
  const Vec3f up(0, 0, 1.2f), x(0.8f, 0, 0), y(0, 0.8f, 0), corner(-0.4f, -0.4f, 0.81f), far = corner + x + y;
  for (const VisualMesh& side : {quad(corner, x, up), quad(corner, y, up), quad(far, -x, up), quad(far, -y, up)})
    add(scene, side, material(Kind::diffuse, Vec3f::Zero()));
  look_at(scene, {0, -2.5, 0.9}, {0, 0.3, 0.3}, 24, 16, 20);
  return scene;
}

Scene below_a_pane_with_lamp() {
  Scene scene = below_a_pane();
  add_light(scene, {-0.3, -0.3, 1.6}, {0, 0.6, 0}, {0.6, 0, 0}, {30, 30, 30});
  return scene;
}

// The lamp shines at a mirror in the plane x = 1, away from the floor that is seen: all its light comes from its image.
TEST_F(LightTracing, MirrorThrowsALampAsItsImage) {
  Scene scene;
  add(scene, quad({-0.25f, -0.25f, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}), material(Kind::diffuse, Vec3f::Constant(0.5f)));
  VisualMaterial mirror = material(Kind::conductor, {0.8f, 0.8f, 0.8f});
  mirror.roughness = 0;
  mirror.color = Vec3f::Ones();
  add(scene, quad({1, -0.25f, 0.1f}, {0, 0.5f, 0}, {0, 0, 0.4f}), mirror);
  add_light(scene, {0.2, -0.1, 0.5}, {0, 0.2, 0}, {0, 0, 0.2}, {6, 6, 6});  // toward +x
  look_at(scene, {0, 0, 0.6}, {0, 0, 0}, 16, 16, 24);
  const std::vector<Vec3> image = {{1.8, -0.1, 0.5}, {1.8, 0.1, 0.5}, {1.8, 0.1, 0.7}, {1.8, -0.1, 0.7}};
  double expected = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)  // straight down: pixel (0, 0) is at the corner of the seen square
      expected +=
          6 * 0.5 / M_PI / 256 * irradiance(image, Vec3(0.6 / 24 * (x - 7.5), 0.6 / 24 * (y - 7.5), 0), Vec3::UnitZ());
  Device device;
  const Mean with = mean_of_seeds(device, scene, 1024, 8, 3);
  EXPECT_LT(with.sigma, 0.015 * with.value);
  EXPECT_NEAR(with.value, expected, 4 * with.sigma + 1e-3 * expected);
}

TEST_F(LightTracing, BringsTheLightOfCameraPathsFromARectangle) { expect_same_light(below_a_pane_with_lamp()); }

TEST_F(LightTracing, EndsAfterAsManyBouncesAsCameraPaths) {
  expect_same_light(below_a_pane_with_lamp(), 3);
  expect_same_light(below_a_pane_with_lamp(), 4);
}

TEST_F(LightTracing, BringsTheLightOfSpheresAndSpots) {
  for (const bool is_spot : {false, true}) {
    Scene scene = below_a_pane();
    scene.sphere_lights.push_back({"ball", {0.05, 0.1, 1.6}, 0.25, {30, 30, 30}});
    if (is_spot) {
      scene.sphere_lights.back().direction = {0, 0, -1};
      scene.sphere_lights.back().inner_angle = 0.3;
      scene.sphere_lights.back().outer_angle = 1.2;
    }
    expect_same_light(scene, 8, 1024);
  }
}

TEST_F(LightTracing, BringsTheLightOfMeshesThatShine) {
  Scene scene = below_a_pane();
  VisualMaterial lamp = material(Kind::emissive);
  lamp.emission = {30, 30, 30};
  add(scene, quad({-0.3f, -0.3f, 1.5f}, {0.6f, 0, 0}, {0, 0.6f, 0.2f}), lamp);
  expect_same_light(scene);
}

TEST_F(LightTracing, BringsTheSameThroughADistortedLens) {
  Scene scene = below_a_pane_with_lamp();
  scene.cameras[0].distortion = {-0.2, 0.05, 0.002, -0.001};
  expect_same_light(scene);
  scene.cameras[0].lens_radius = 0.05;
  scene.cameras[0].focus_distance = 2;
  expect_same_light(scene);
}

TEST_F(LightTracing, SharesItsPathsAmongTheInstantsOfAnExposure) {
  Scene scene = below_a_pane_with_lamp();
  scene.cameras[0].exposure_time = 0.02;
  expect_same_light(scene);
}

TEST_F(LightTracing, BringsTheSameThroughAFisheye) {
  Scene scene = below_a_pane_with_lamp();
  scene.cameras[0].model = Camera::Model::fisheye;
  scene.cameras[0].distortion = {0.02, -0.01, 0.003, -0.0005};
  expect_same_light(scene);
}

// the camera and the floor in a basin of water, the lamp above it
TEST_F(LightTracing, BringsTheSameUnderWater) {
  Scene scene = below_a_pane_with_lamp();
  VisualMaterial water = material(Kind::dielectric);
  water.index_of_refraction = 1.33f;
  water.absorption = {0.1f, 0.3f, 0.2f};
  scene.visuals.erase(scene.visuals.begin() + 2, scene.visuals.begin() + 4);  // pane and ball
  add(scene, box({-5, -5, -1}, {5, 5, 1.3f}), water);
  expect_same_light(scene);
}

// what a lamp inside of a solid sends is left to camera paths
TEST_F(LightTracing, LeavesLampsInsideOfGlassAlone) {
  Scene scene = below_a_pane();
  VisualMaterial glass = material(Kind::dielectric);
  add(scene, box({-0.35f, -0.35f, 1.4f}, {0.35f, 0.35f, 1.75f}), glass);
  add_light(scene, {-0.3, -0.3, 1.6}, {0, 0.6, 0}, {0.6, 0, 0}, {30, 30, 30});
  expect_same_light(scene);
}

TEST_F(LightTracing, GivesTheSameBitsAgain) {
  const Scene scene = below_a_pane_with_lamp();
  Device device;
  EXPECT_EQ(caustics(device, scene, 8, 3).rgb, caustics(device, scene, 8, 3).rgb);
  EXPECT_NE(caustics(device, scene, 8, 3).rgb, caustics(device, scene, 8, 4).rgb);
}

Scene ball_of_glass() {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), material(Kind::diffuse, Vec3f::Constant(0.7f)));
  add(scene, sphere(0.25f, 48), material(Kind::dielectric), Vec3(0, 0, 0.4));
  look_at(scene, {0, -2, 1.2}, {0, 0, 0}, 32, 24, 32);
  return scene;
}

// of light paths over camera paths alone: a quarter of the noise's square at most (measured: an eighth)
void expect_little_noise(const Scene& scene) {
  Device device;
  const RenderedFrame truth = caustics(device, scene, 1024, 99);
  const auto error = [&](const RenderedFrame& frame) {
    double sum = 0;
    for (std::size_t i = 0; i < frame.rgb.size(); ++i)
      sum += std::pow(frame.rgb[i] - truth.rgb[i], 2) / (std::pow(truth.rgb[i], 2) + 0.01);
    return sum / double(frame.rgb.size());
  };
  EXPECT_LT(error(caustics(device, scene, 16, 1)), 0.25 * error(caustics(device, without_light_paths(scene), 16, 1)));
}

TEST_F(LightTracing, LeavesLittleOfTheNoiseOfASmallLamp) {
  Scene scene = ball_of_glass();
  add_light(scene, {-0.05, -0.05, 2}, {0, 0.1, 0}, {0.1, 0, 0}, {100, 100, 100});
  expect_little_noise(scene);
}

TEST_F(LightTracing, LeavesLittleOfTheNoiseOfASmallBall) {
  Scene scene = ball_of_glass();
  scene.sphere_lights.push_back({"ball", {0, 0, 2}, 0.05, {100, 100, 100}});
  expect_little_noise(scene);
}

}  // namespace
}  // namespace pvg::test
