// Light transport against known answers: furnaces, the form factor of a rectangle, an integrating sphere.
#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Furnace = ManyPaths;
using Light = ManyPaths;

Scene in_furnace(const VisualMaterial& m, VisualMesh mesh) {
  Scene scene;
  add(scene, std::move(mesh), m);
  scene.environment = Vec3f::Ones();
  look_at(scene, {0, -3, 0.4}, {0, 0, 0}, 32, 32, 36);  // the object fills most of the picture
  return scene;
}

TEST_F(Furnace, WhiteDiffuseCannotBeSeen) {
  const RenderedFrame frame = picture(in_furnace(material(Kind::diffuse), box({-1, -1, -1}, {1, 1, 1})), 16);
  for (const float c : frame.rgb) ASSERT_NEAR(c, 1, 1e-5);
}

TEST_F(Furnace, ClearGlassCannotBeSeen) {
  for (const bool is_box : {false, true}) {
    const RenderedFrame frame = picture(
        in_furnace(material(Kind::dielectric), is_box ? box({-1, -1, -1}, {1, 1, 1}) : sphere(1, 48)), 16, true, 400);
    // a box traps a few rays by total reflection for good; everything else comes out with weight 1
    EXPECT_GE(mean(frame).value, is_box ? 0.9 : 0.9999);
    for (const float c : frame.rgb) ASSERT_LE(c, 1 + 1e-5);
  }
}

TEST_F(Furnace, ConductorLosesALittle) {
  for (const float roughness : {0.0f, 0.3f, 1.0f}) {
    VisualMaterial m = material(Kind::conductor);
    m.roughness = roughness;
    const RenderedFrame frame = picture(in_furnace(m, sphere(1, 48)), 16);
    for (const float c : frame.rgb) ASSERT_LE(c, 1 + 1e-5);
    EXPECT_GE(mean(frame).value, roughness < 1 ? 0.97 : 0.3);
  }
}

TEST_F(Light, DiffuseFloorUnderRectanglesHasTheAnalyticRadiance) {
  Scene scene;
  add(scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), material(Kind::diffuse, {0.5f, 0.25f, 1.0f}));
  // one straight above and large, one small, tilted, aside
  const Vec3 a(-0.4, -0.3, 0.5), au(0, 0.6, 0), av(0.8, 0, 0);
  const Vec3 b(0.9, 0.2, 0.3), bu(0.05, 0.3, 0), bv(-0.1, 0.05, 0.3);
  add_light(scene, a, au, av, {3, 3, 3});
  add_light(scene, b, bv, bu, {0, 20, 0});
  const Vec3 point(0.2, 0.1, 0);
  look_at(scene, {0.2, -1, 0.2}, point, 32, 32, 1e5);  // all pixels see the same half millimetre
  const RenderedFrame frame = picture(scene, 64);
  const double Ea = 3 * irradiance({a, a + au, a + au + av, a + av}, point, Vec3::UnitZ());
  const double Eb = 20 * irradiance({b, b + bu, b + bu + bv, b + bv}, point, Vec3::UnitZ());
  const Mean red = mean(frame, 0), green = mean(frame, 1);
  EXPECT_LT(red.sigma, 0.01 * red.value);
  EXPECT_NEAR(red.value, 0.5 / M_PI * Ea, 4 * red.sigma + 1e-4);
  EXPECT_NEAR(green.value, 0.25 / M_PI * (Ea + Eb), 4 * green.sigma + 1e-4);
}

// A conductor's highlight by light samples and by its own samples together; the truth is a picture without lights in
// which the same rectangle is an emissive mesh, found by the conductor's samples alone.
TEST_F(Light, HighlightOfAConductorIsThatOfAnEmissiveMesh) {
  for (const float roughness : {0.2f, 0.5f}) {
    VisualMaterial metal = material(Kind::conductor, {0.9f, 0.6f, 0.3f});
    metal.roughness = roughness;
    VisualMaterial lamp = material(Kind::emissive);
    lamp.emission = Vec3f::Constant(5);
    Scene light, mesh;
    for (Scene* scene : {&light, &mesh}) {
      add(*scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), metal);
      look_at(*scene, {0, -1, 0.6}, {0, 0, 0}, 16, 16, 200);
    }
    add_light(light, {-0.2, 0.7, 0.4}, {0.4, 0, 0}, {0, 0, 0.4}, Vec3f::Constant(5));
    add(mesh, quad({-0.2f, 0.7f, 0.4f}, {0, 0, 0.4f}, {0.4f, 0, 0}), lamp);
    const Mean a = mean(picture(light, 256)), b = mean(picture(mesh, 1024));
    EXPECT_GT(b.value, 0.1);
    // pixels differ by more than noise: the spread is an upper bound of the error
    EXPECT_NEAR(a.value, b.value, 0.01 * b.value);
  }
}

// In a sphere every patch lights every other equally: what comes after the first reflection is, for a light of power
// pi L a in a sphere of area A and albedo rho, the radiance rho^2 L a / (A (1 - rho)). The lower half sees nothing
// else.
TEST_F(Light, IntegratingSphereIsEvenlyLit) {
  const double rho = 0.7, L = 500, a = 0.02 * 0.02;
  VisualMesh shell = sphere(1, 64);
  for (Triangle& t : shell.triangles) std::swap(t[1], t[2]);  // seen from inside
  for (Vec3f& n : shell.normals) n = -n;
  Scene scene;
  add(scene, shell, material(Kind::diffuse, Vec3f::Constant(float(rho))));
  add_light(scene, {-0.01, -0.01, 0}, {0.02, 0, 0}, {0, 0.02, 0}, Vec3f::Constant(float(L)));
  look_at(scene, {0, 0.1, -0.2}, {0.1, 0.2, -0.9}, 48, 48, 40);
  const Mean measured = mean(picture(scene, 64));
  const double expected = rho * rho * L * a / (4 * M_PI * (1 - rho));
  EXPECT_NEAR(measured.value, expected, 4 * measured.sigma + 0.005 * expected);
}

TEST_F(Light, ShinesOnOneSideAndIsSeen) {
  Scene scene;
  add_light(scene, {-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, {2, 3, 4});  // downward
  look_at(scene, {0, 0, 0}, {0, 0, 1}, 8, 8, 20);
  const RenderedFrame below = picture(scene, 4);
  EXPECT_NEAR(below.rgb[0], 2, 1e-5);
  EXPECT_NEAR(below.rgb[2], 4, 1e-5);
  EXPECT_EQ(below.instance[0], 0u);
  EXPECT_NEAR(below.depth[0], 1, 1e-5);
  scene.cameras.clear();
  look_at(scene, {0, 0, 2}, {0, 0, 1}, 8, 8, 20);
  EXPECT_EQ(picture(scene, 4).rgb[0], 0);
}

TEST_F(Light, ExposureMultipliesRadianceButNotAReceiversTexture) {
  Scene scene;
  VisualMaterial receiver = material(Kind::shadow_receiver, Vec3f::Constant(0.3f));
  receiver.shadow_strength = 0;
  add(scene, quad({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), receiver);
  scene.environment = Vec3f::Constant(0.25f);
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 8, 8, 8).exposure = 2;
  const RenderedFrame frame = picture(scene, 1);
  EXPECT_NEAR(*std::max_element(frame.rgb.begin(), frame.rgb.end()), 0.5, 1e-6);
  EXPECT_NEAR(*std::min_element(frame.rgb.begin(), frame.rgb.end()), 0.3, 1e-6);
}

// a sphere of radiance L and radius r whose centre stands at distance d, at the angle theta from the normal, all above
// the horizon: E = pi L (r / d)^2 cos(theta)
TEST_F(Light, SphereLightHasTheAnalyticIrradiance) {
  Scene scene;
  add(scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), material(Kind::diffuse, Vec3f::Constant(0.5f)));
  scene.sphere_lights.push_back({"ball", {0.3, 0.4, 1.2}, 0.25, {5, 5, 5}});
  look_at(scene, {0, -1, 0.2}, {0, 0, 0}, 32, 32, 1e5);
  const double d2 = 0.3 * 0.3 + 0.4 * 0.4 + 1.2 * 1.2, cosine = 1.2 / std::sqrt(d2);
  const double E = M_PI * 5 * (0.25 * 0.25 / d2) * cosine;
  const Mean measured = mean(picture(scene, 64));
  EXPECT_LT(measured.sigma, 2e-3 * measured.value);
  EXPECT_NEAR(measured.value, 0.5 / M_PI * E, 4 * measured.sigma + 1e-4 * E);
}

// a mirror sees the ball itself, through the triangles that stand for it
TEST_F(Light, SphereLightIsSeenAsLargeAsItIs) {
  Scene scene;
  scene.sphere_lights.push_back({"ball", {0, 5, 0}, 1, {2, 2, 2}});
  look_at(scene, {0, 0, 0}, {0, 1, 0}, 200, 200, 300);
  const Mean seen = mean(picture(scene, 16));
  // the cone of half angle asin(1 / 5) meets the picture's plane in a disc of radius f tan
  const double radius = 300 * std::tan(std::asin(0.2));
  EXPECT_NEAR(seen.value, 2 * M_PI * radius * radius / (200 * 200), 2e-3);
}

// The same rectangle as a light and as a mesh that shines: both are sampled, so both pictures have little noise.
TEST_F(Light, AShiningMeshLightsAsARectangleLightDoes) {
  Scene light, mesh;
  for (Scene* scene : {&light, &mesh}) {
    add(*scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), material(Kind::diffuse, Vec3f::Constant(0.5f)));
    look_at(*scene, {0, -1, 0.2}, {0, 0, 0}, 32, 32, 1e5);
  }
  add_light(light, {-0.1, 0.2, 0.5}, {0, 0.2, 0}, {0.3, 0, 0}, Vec3f::Constant(5));
  VisualMaterial lamp = material(Kind::emissive);
  lamp.emission = Vec3f::Constant(5);
  Visual& shining = add(mesh, quad({0, 0, 0}, {0, 0.2f, 0}, {0.3f, 0, 0}), lamp);
  shining.pose.translation() = Vec3(-0.1, 0.2, 0.5);
  const Mean a = mean(picture(light, 64)), b = mean(picture(mesh, 64));
  EXPECT_LT(b.sigma, 0.01 * b.value);
  EXPECT_NEAR(a.value, b.value, 4 * std::hypot(a.sigma, b.sigma));
}

// 64 lights in a ring, of very different power: as bright as the sum of their irradiances
TEST_F(Light, ManyLightsAddUp) {
  Scene scene;
  add(scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), material(Kind::diffuse));
  double E = 0;
  for (int i = 0; i < 64; ++i) {
    const double angle = 2 * M_PI * i / 64, L = 0.5 + i % 7;
    const Vec3 corner(std::cos(angle), std::sin(angle), 1), u(0, 0.05, 0), v(0.05, 0, 0);
    add_light(scene, corner, u, v, Vec3f::Constant(float(L)));
    E += L * irradiance({corner, corner + u, corner + u + v, corner + v}, Vec3::Zero(), Vec3::UnitZ());
  }
  look_at(scene, {0, -1, 0.2}, {0, 0, 0}, 32, 32, 1e5);
  const Mean measured = mean(picture(scene, 64));
  EXPECT_NEAR(measured.value, E / M_PI, 4 * measured.sigma);
  EXPECT_LT(measured.sigma, 0.01 * measured.value);
}

// The upper half of the sky shines, a small patch of it a thousand times as much; seen by a diffuse floor, whose
// irradiance is the integral over the picture.
TEST_F(Light, EnvironmentPictureLightsAFloorAsItsIntegralSays) {
  Scene scene;
  add(scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), material(Kind::diffuse));
  EnvironmentMap& map = scene.environment_map;
  map.width = 64;
  map.height = 32;
  map.turn = 0.5;
  scene.environment = {1, 1, 2};
  double E = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const bool is_patch = y == 6 && x == 40;
      const float L = y >= 16 ? 0 : is_patch ? 1000.0f : 1.0f;
      map.rgb.insert(map.rgb.end(), {L, L, L});
    }
  look_at(scene, {0, -1, 0.2}, {0, 0, 0}, 32, 32, 1e5);
  const RenderedFrame frame = picture(scene, 64);
  // by the midpoint rule over directions, linear between the centres of the pixels
  const int n = 16;
  const auto value = [&](double u, double v) {
    const double x = u * 64 - 0.5, y = std::clamp(v * 32 - 0.5, 0.0, 31.0);
    const int x0 = int(std::floor(x)), y0 = int(y), y1 = std::min(y0 + 1, 31);
    const double a = x - x0, b = y - y0;
    const auto at = [&](int i, int j) { return double(map.rgb[std::size_t(3 * (j * 64 + (i + 64) % 64))]); };
    return (1 - b) * ((1 - a) * at(x0, y0) + a * at(x0 + 1, y0)) + b * ((1 - a) * at(x0, y1) + a * at(x0 + 1, y1));
  };
  for (int j = 0; j < 16 * n; ++j)
    for (int i = 0; i < 64 * n; ++i) {
      const double v = (j + 0.5) / (32.0 * n), theta = M_PI * v;
      E += value((i + 0.5) / (64.0 * n), v) * std::cos(theta) * std::sin(theta) * M_PI / (32 * n) * 2 * M_PI / (64 * n);
    }
  const Mean red = mean(frame, 0), blue = mean(frame, 2);
  EXPECT_LT(red.sigma, 0.02 * red.value);
  EXPECT_NEAR(red.value, E / M_PI, 4 * red.sigma + 1e-3 * E);
  EXPECT_NEAR(blue.value, 2 * red.value, 1e-3 * blue.value);
}

TEST_F(Light, EnvironmentIsSeenWhereItsPictureSays) {
  Scene scene;
  EnvironmentMap& map = scene.environment_map;
  map.width = 64;
  map.height = 32;
  map.rgb.assign(64 * 32 * 3, 0.0f);
  map.rgb[3 * (16 * 64 + 16)] = 1;  // a quarter from the left: +y, a little below the horizon
  scene.environment = Vec3f::Ones();
  const double below = M_PI * (16.5 / 32 - 0.5), aside = 2 * M_PI * 0.5 / 64;
  look_at(scene, {0, 0, 0}, Vec3(-std::sin(-aside), std::cos(aside), -std::tan(below)), 4, 4, 4000);
  EXPECT_NEAR(picture(scene, 4).rgb[0], 1, 0.02);
}

}  // namespace
}  // namespace pvg::test
