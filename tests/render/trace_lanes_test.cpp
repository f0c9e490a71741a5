// Paths that a CPU takes through all stages in chunks, and shades sixteen at once (kernels/render/lanes), against the
// same paths one by one, each stage a launch, as a GPU takes them (kernels/render/wavefront).
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using TraceLanes = ManyPaths;

Texture stripes() {
  Texture texture;
  texture.width = 32;
  texture.height = 16;
  for (int i = 0; i < 32 * 16; ++i)
    for (const int c : {8 * (i % 32), 255 - 15 * (i / 32), 100 + i % 32, 255}) texture.rgba.push_back(std::uint8_t(c));
  return texture;
}

// A sphere, a turned box and a leaning plate with a texture on a diffuse floor. All kinds of lamps shine: a rectangle,
// one that looks away, a ball, a spot, a plate that shines, and an even sky.
Scene things(const VisualMaterial& m) {
  Scene scene;
  scene.textures.push_back(stripes());
  VisualMaterial wood = material(Kind::diffuse, {0.8f, 0.7f, 0.5f});
  wood.texture = 0;
  add(scene, quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), wood);
  add(scene, sphere(0.35f, 12), m, {-0.5, 0, 0.4}).pose.linear() =
      Eigen::AngleAxisd(0.7, Vec3(3, 1, 2).normalized()).toRotationMatrix();
  add(scene, box({-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}), m, {0.5, 0.1, 0.4}).pose.linear() =
      Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  VisualMaterial striped = m;
  striped.texture = 0;
  add(scene, quad({-0.6f, 0.7f, 0.05f}, {1.2f, 0, 0}, {0, 0.3f, 0.8f}), striped);
  add_light(scene, {-0.2, -0.3, 2}, {0, 0.6, 0}, {0.4, 0, 0}, {12, 11, 10});
  add_light(scene, {-1.8, 0.5, 0.5}, {0, 0, 0.3}, {0, 0.3, 0}, {9, 9, 9});
  scene.sphere_lights.push_back({"ball", {0.8, -0.9, 1.1}, 0.1, {20, 25, 30}});
  scene.sphere_lights.push_back(
      {"spot", {-0.9, -0.9, 1.4}, 0.05, {200, 150, 100}, Vec3(1, 1, -1).normalized(), 0.2, 0.6});
  VisualMaterial shining = material(Kind::emissive);
  shining.emission = {8, 9, 7};
  add(scene, quad({0.9f, 0.4f, 0.7f}, {0, -0.3f, 0}, {0, 0, 0.3f}), shining);
  scene.environment = Vec3f(0.2f, 0.25f, 0.3f);
  for (VisualMesh& mesh : scene.visual_meshes)  // no corner is at 0
    for (Vec2f& uv : mesh.uvs) uv += Vec2f(0.3f, 0.2f);
  // neither the chunks of paths nor the last sixteen of them are full
  look_at(scene, {0.1, -2.2, 1.1}, {0, 0, 0.3}, 61, 37, 60);
  return scene;
}

void put_picture_of_sky(Scene& scene) {
  scene.environment_map.width = 16;
  scene.environment_map.height = 8;
  for (int i = 0; i < 3 * 16 * 8; ++i) scene.environment_map.rgb.push_back(float(i % 37) / 10);
}

RenderSettings with_notes(bool transparent_shadows = true) {
  RenderSettings settings;
  settings.samples = 8;
  settings.notes_features = true;
  settings.transparent_shadows = transparent_shadows;
  return settings;
}

RenderedFrame shaded(const Scene& scene, RenderSettings settings, bool is_wavefront) {
  Device device;
  settings.is_wavefront = is_wavefront;
  return Renderer(device, scene, settings).render(0, 0);
}

// The share of numbers that differ by more than rounding. Where rounding lets a path meet the other of two surfaces, or
// go on where the other ends, its pixel differs.
double share_of_others(const std::vector<float>& a, const std::vector<float>& b) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) n += !(std::abs(a[i] - b[i]) <= 2e-4f * (1 + std::abs(a[i])));
  return double(n) / double(std::max<std::size_t>(1, a.size()));
}

void expect_the_same(const Scene& scene, const RenderSettings& settings = with_notes()) {
  const RenderedFrame a = shaded(scene, settings, false), b = shaded(scene, settings, true);
  EXPECT_LE(std::abs(double(a.rays) / double(b.rays) - 1), 0.001);
  ASSERT_EQ(a.rgb.size(), b.rgb.size());
  EXPECT_LE(share_of_others(a.rgb, b.rgb), 0.001);
  EXPECT_NE(a.albedo.empty(), settings.notes_features);
  EXPECT_LE(share_of_others(a.albedo, b.albedo), 0.001);
  EXPECT_LE(share_of_others(a.mean_normal, b.mean_normal), 0.001);
  const auto [least, most] = std::ranges::minmax(a.rgb);
  EXPECT_GT(most - least, 0.3f);
}

TEST_F(TraceLanes, DiffuseSurfaces) { expect_the_same(things(material(Kind::diffuse, {0.7f, 0.4f, 0.2f}))); }

TEST_F(TraceLanes, RoughMetals) {
  VisualMaterial m = material(Kind::conductor, {0.9f, 0.7f, 0.4f});
  m.roughness = 0.5f;
  m.edge_dip = Vec3f(0.3f, 0.2f, 0.1f);
  expect_the_same(things(m));
}

TEST_F(TraceLanes, CoatedSurfaces) {
  for (const float metallic : {0.0f, 0.4f, 0.8f}) {
    VisualMaterial m = material(Kind::metallic_roughness, {0.8f, 0.5f, 0.3f});
    m.roughness = 0.45f;
    m.metallic = metallic;
    expect_the_same(things(m));
  }
}

TEST_F(TraceLanes, GlassThatAbsorbsWithAnotherInside) {
  VisualMaterial glass = material(Kind::dielectric, {0.95f, 0.9f, 1});
  glass.absorption = {0.3f, 0.1f, 0.9f};
  VisualMaterial water = material(Kind::dielectric);
  water.index_of_refraction = 1.33f;
  water.absorption = {2, 0.5f, 0.1f};
  for (const bool transparent : {true, false}) {  // false: lamps are traced as well
    Scene scene = things(glass);
    add(scene, sphere(0.2f, 10), water, {-0.5, 0, 0.4});
    add(scene, box({-0.15f, -0.15f, -0.1f}, {0.15f, 0.15f, 0.3f}), water, {0.5, 0.1, 0.4});  // through the glass box
    expect_the_same(scene, with_notes(transparent));
  }
}

// Interpolated normals lean far from the faces: many paths are bent to the wrong side, and bent anew. The glass
// absorbs, as such faces bring paths that rounding parts ever further from each other.
TEST_F(TraceLanes, GlassOfFewFaces) {
  Scene scene = things(material(Kind::diffuse, {0.7f, 0.4f, 0.2f}));
  VisualMaterial glass = material(Kind::dielectric);
  glass.absorption = Vec3f::Constant(4);
  for (const double x : {-0.5, 0.3}) add(scene, sphere(0.35f, 4), glass, {x, -0.6, 0.4});
  expect_the_same(scene);
}

// Paths from the floor pass the plate and meet the lamp, which their shadow rays have found already.
TEST_F(TraceLanes, LightThroughAPlateOfGlass) {
  VisualMaterial coated = material(Kind::metallic_roughness, {0.8f, 0.5f, 0.3f}), metal = coated;
  metal.metallic = 0.8f;  // not matte: glass stops its shadow rays
  metal.roughness = coated.roughness = 0.6f;
  for (const VisualMaterial& m : {material(Kind::diffuse, {0.8f, 0.5f, 0.3f}), coated, metal}) {
    Scene scene = things(m);
    add(scene, box({-1.5f, -1.5f, 1}, {1.5f, 1.5f, 1.1f}), material(Kind::dielectric));
    add_light(scene, {-1, -1, 1.5}, {0, 2, 0}, {2, 0, 0}, {3, 3, 3});
    scene.cameras.clear();
    look_at(scene, {0.1, -2.2, 0.8}, {0, 0, 0.2}, 64, 36, 60);
    expect_the_same(scene);
    expect_the_same(scene, with_notes(false));  // the lamps are traced as well, and weighted against these paths
  }
}

TEST_F(TraceLanes, PathsThatLampsTraceToo) {
  VisualMaterial m = material(Kind::metallic_roughness, {0.8f, 0.5f, 0.3f});
  m.roughness = 0.45f;
  m.metallic = 0.4f;
  Scene scene = things(m);
  add(scene, sphere(0.3f, 12), material(Kind::dielectric), {0, -0.5, 0.4});
  expect_the_same(scene, with_notes(false));
}

TEST_F(TraceLanes, ShadowReceivers) {
  VisualMaterial m = material(Kind::shadow_receiver, {0.9f, 0.8f, 0.7f});
  m.shadow_strength = 0.7f;
  m.ambient = 0.3f;
  Scene scene = things(m);
  for (Visual& visual : scene.visuals) visual.casts_shadow_on_receivers = false;
  add(scene, box({-0.1f, -0.3f, 0.9f}, {0.4f, 0.3f, 1}), material(Kind::diffuse));
  // a mirror in which they are met by paths that have a way behind them
  VisualMaterial mirror = material(Kind::conductor, {0.9f, 0.9f, 0.9f});
  mirror.roughness = 0;
  add(scene, quad({-1, 1.2f, 0}, {2, 0, 0}, {0, 0.2f, 1.5f}), mirror);
  expect_the_same(scene);
  put_picture_of_sky(scene);  // a light: receivers are shaded one by one then
  expect_the_same(scene);
}

TEST_F(TraceLanes, UnderAPictureOfTheSky) {
  VisualMaterial m = material(Kind::metallic_roughness, {0.8f, 0.5f, 0.3f});
  m.roughness = 0.45f;
  Scene scene = things(m);
  put_picture_of_sky(scene);
  expect_the_same(scene);
}

TEST_F(TraceLanes, PathsThatLeaveIntoTheDark) {
  Scene scene = things(material(Kind::dielectric));
  scene.environment = Vec3f::Zero();
  for (const bool transparent : {true, false}) {
    RenderSettings settings = with_notes(transparent);
    expect_the_same(scene, settings);
    settings.notes_features = false;
    expect_the_same(scene, settings);
  }
}

// rays of plain cameras start sixteen at a time, these one by one
TEST_F(TraceLanes, CamerasWithALensOrDistortion) {
  const Scene plain = things(material(Kind::diffuse, {0.7f, 0.4f, 0.2f}));
  for (const int kind : {0, 1, 2}) {
    Scene scene = plain;
    Camera& camera = scene.cameras[0];
    if (kind == 0) camera.lens_radius = 0.02;
    if (kind == 0) camera.focus_distance = 2;
    if (kind > 0) camera.distortion = {-0.1, 0.02, 0.001, 0.002};
    if (kind == 2) camera.model = Camera::Model::fisheye;
    expect_the_same(scene);
  }
}

// Of surfaces that scatter the last bounce shows their own light alone. Cut-out surfaces keep shadow rays for later.
TEST_F(TraceLanes, FewBounces) {
  VisualMaterial m = material(Kind::metallic_roughness, {0.8f, 0.5f, 0.3f});
  m.emission = {0.1f, 0.2f, 0.1f};
  const Scene plain = things(material(Kind::diffuse, {0.7f, 0.4f, 0.2f}));
  Scene with_holes = things(m);
  m.alpha_mode = VisualMaterial::AlphaMode::blend;
  m.opacity = 0.4f;
  add(with_holes, quad({-0.8f, -0.8f, 0.1f}, {1.6f, 0, 0}, {0, 0, 0.5f}), m);
  for (const Scene& scene : {plain, with_holes})
    for (const int bounces : {0, 1, 2}) {
      RenderSettings settings = with_notes();
      settings.max_depth = bounces;
      expect_the_same(scene, settings);
    }
}

TEST_F(TraceLanes, SurfacesWithHoles) {
  VisualMaterial veil = material(Kind::diffuse, {0.8f, 0.5f, 0.3f});
  Scene scene = things(veil);
  for (std::size_t i = 3; i < scene.textures[0].rgba.size(); i += 12) scene.textures[0].rgba[i] = 0;
  for (VisualMaterial& m : scene.materials)
    if (m.texture == 0) m.alpha_mode = VisualMaterial::AlphaMode::mask;
  veil.alpha_mode = VisualMaterial::AlphaMode::blend;
  veil.opacity = 0.4f;
  add(scene, quad({-0.8f, -0.8f, 0.1f}, {1.6f, 0, 0}, {0, 0, 0.5f}), veil);
  expect_the_same(scene);
}

// seen end on: light goes along the rod over more faces than there are bounces
TEST_F(TraceLanes, LightThatARodOfGlassLeads) {
  Scene scene = things(material(Kind::diffuse, {0.7f, 0.4f, 0.2f}));
  VisualMaterial glass = material(Kind::dielectric);
  glass.absorption = {0.5f, 0.1f, 1};
  add(scene, box({-0.3f, -0.9f, 0.3f}, {0.3f, 0.4f, 0.34f}), glass);
  expect_the_same(scene);
}

// Plates and boxes that are like those which are shaded sixteen at once, but for one thing each.
TEST_F(TraceLanes, SurfacesThatAreShadedOneByOne) {
  Scene scene = things(material(Kind::diffuse, {0.7f, 0.4f, 0.2f}));
  scene.textures.push_back(stripes());  // of plain values
  int n = 0;
  const auto next_place = [&] {
    const int i = n++;
    return Vec3f(-0.85f + 0.35f * float(i % 5), -0.8f + 0.3f * float(i / 5), 0.1f + 0.45f * float(i / 5));
  };
  const auto plate = [&] { return quad(next_place(), {0.3f, 0.05f, 0}, {0, 0.1f, 0.3f}); };
  VisualMaterial coated = material(Kind::metallic_roughness, {0.8f, 0.5f, 0.3f});
  coated.roughness = 0.45f;
  VisualMesh mesh = plate();
  mesh.colors = {{1, 0.2f, 0.2f}, {0.2f, 1, 0.2f}, {0.2f, 0.2f, 1}, {1, 1, 1}};
  add(scene, mesh, coated);
  VisualMaterial m = material(Kind::diffuse);
  m.texture = 0;
  m.on_second_uvs = VisualMaterial::color_bit;
  mesh = plate();
  for (const Vec2f& uv : mesh.uvs) mesh.second_uvs.push_back(Vec2f(0.9f - 0.4f * uv.x(), 0.2f + 0.3f * uv.y()));
  add(scene, mesh, m);
  m = coated;
  m.emission = {0.5f, 0.9f, 0.4f};
  add(scene, plate(), m);
  m = material(Kind::diffuse, {0.8f, 0.8f, 0.8f});
  m.normal_texture = 1;
  add(scene, plate(), m);
  m = coated;
  m.metallic_roughness_texture = 1;
  m.metallic = 1;
  add(scene, plate(), m);
  m = coated;
  m.transmission = 0.6f;
  m.is_thin = true;
  add(scene, plate(), m);
  m = material(Kind::conductor, {0.9f, 0.7f, 0.4f});
  m.roughness = 0;
  add(scene, plate(), m);
  m = material(Kind::dielectric, {0.9f, 0.6f, 0.5f});
  m.is_thin = true;
  add(scene, plate(), m);
  const auto block = [&] {
    const Vec3f lo = next_place();
    VisualMesh sides = box(lo, lo + Vec3f(0.25f, 0.1f, 0.25f));
    for (const Vec3f& p : sides.points) sides.uvs.push_back(Vec2f(2 * p.x(), 3 * p.z()));
    return sides;
  };
  m = coated;
  m.transmission = 0.6f;
  add(scene, block(), m);
  m = material(Kind::dielectric);
  m.absorption = {0.5f, 0.1f, 1};
  m.texture = 0;
  add(scene, block(), m);
  expect_the_same(scene);
}

TEST_F(TraceLanes, NothingButAnEvenSky) {
  Scene scene;
  scene.environment = Vec3f(0.2f, 0.25f, 0.3f);
  look_at(scene, {0, 0, 2}, {0, 0, 0}, 40, 30, 60);
  for (const bool is_wavefront : {false, true}) {
    const RenderedFrame frame = shaded(scene, with_notes(), is_wavefront);
    for (std::size_t i = 0; i < frame.rgb.size(); ++i) EXPECT_NEAR(frame.rgb[i], scene.environment[i % 3], 1e-6);
    EXPECT_EQ(frame.rays, 8u * 40 * 30);
  }
}

}  // namespace
}  // namespace pvg::test
