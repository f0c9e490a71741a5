// A mesh embedded in a soft body, as it is seen: it goes with the body, keeps its texture, and must be near it.
#include "host/render/soft_visual.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "tests/expect_error.hpp"
#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

// a bar of 20 x 4 x 4 cm, a square plate of 2 cm embedded at its middle, 1 mm above it
Scene plate_on_bar(double height) {
  Scene scene;
  SoftBody bar;
  bar.name = "bar";
  bar.mesh = box_solid({0.2, 0.04, 0.04}, {5, 1, 1}, 10);
  scene.soft_bodies = {bar};
  VisualMaterial receiver = material(VisualMaterial::Kind::shadow_receiver);
  receiver.shadow_strength = 0;
  receiver.texture = 0;
  scene.textures.push_back({2, 1, {255, 0, 0, 255, 0, 255, 0, 255}});
  Visual& plate = add(scene, quad({-0.01f, -0.01f, float(height)}, {0.02f, 0, 0}, {0, 0.02f, 0}), receiver);
  plate.soft = 0;
  return scene;
}

SceneState moved_by(const Scene& scene, const Eigen::Isometry3d& motion) {
  SceneState state = initial_state(scene);
  for (Vec3& x : state.soft[0]) x = motion * x;
  return state;
}

TEST(SoftVisual, AnEmbeddedMeshIsSeenWhereItsBodyIs) {
  Scene scene = plate_on_bar(0.021);
  look_at(scene, {1.005, 0.5, 0.3}, {1.005, 0.5, 0}, 8, 8, 1e4);  // the middle of the right half, moved
  Device device;
  RenderSettings settings;
  settings.samples = 1;
  Renderer renderer(device, scene, settings);
  renderer.set_state(moved_by(scene, Eigen::Isometry3d(Eigen::Translation3d(1, 0.5, 0))));
  const RenderedFrame frame = renderer.render(0, 0);
  for (std::size_t i = 0; i < 64; ++i) {
    ASSERT_EQ(frame.instance[i], 1u);
    EXPECT_NEAR(frame.depth[i], 0.3 - 0.021, 1e-5);
    EXPECT_NEAR(frame.rgb[3 * i + 1], 1, 0.05);  // green
    EXPECT_NEAR(frame.normal[3 * i + 2], 1, 1e-4);
  }
}

TEST(SoftVisual, WhatIsFarFromItsBodyIsRefused) {
  // a tenth of the bar's size, sqrt(0.2^2 + 2 0.04^2) m, is 20.8 mm
  EXPECT_EQ(carried_mesh(plate_on_bar(0.02 + 0.0207), plate_on_bar(0).visuals[0]).weights.n_rows(), 4u);
  const Scene far = plate_on_bar(0.02 + 0.021);
  expect_error<UsageError>([&] { carried_mesh(far, far.visuals[0]); },
                           {"visual 0", "21 mm", "soft body bar", "20.8 mm"});
}

// Vertices that differ by their texture coordinates alone share their normal; those of another normal do not.
TEST(SoftVisual, NormalsAreSmoothAcrossSeamsOfTheTexture) {
  CarriedMesh mesh;
  Scene scene = plate_on_bar(0.02);
  VisualMesh& roof = scene.visual_meshes[0];
  const Vec3f a(0, -0.01f, 0.02f), b(0, 0.01f, 0.02f), left(-0.01f, 0, 0.015f), right(0.01f, 0, 0.015f);
  roof.points = {a, b, left, a, b, right};
  roof.uvs = {{0, 0}, {0, 1}, {1, 0}, {1, 0}, {1, 1}, {0, 0}};
  roof.normals.assign(6, Vec3f::UnitZ());
  roof.triangles = {{0, 1, 2}, {3, 5, 4}};
  mesh = carried_mesh(scene, scene.visuals[0]);
  for (const std::size_t ridge : {0, 1, 3, 4})
    EXPECT_LT((moved_normals(mesh, roof.points)[ridge] - Vec3f::UnitZ()).norm(), 1e-6);
  roof.normals = {-Vec3f::UnitX(), -Vec3f::UnitX(), -Vec3f::UnitX(), Vec3f::UnitX(), Vec3f::UnitX(), Vec3f::UnitX()};
  mesh = carried_mesh(scene, scene.visuals[0]);
  EXPECT_LT(moved_normals(mesh, roof.points)[0].x(), -0.4f);
  EXPECT_GT(moved_normals(mesh, roof.points)[3].x(), 0.4f);
}

// A flat cloth of 0.2 x 0.1 m: its texture has four tiles of 50 mm along x and two along y.
TEST(SoftVisual, TheTextureOfAClothRepeatsEveryFiftyMillimetres) {
  Scene scene;
  Cloth cloth;
  cloth.mesh.points = {{-0.1, -0.05, 0}, {0.1, -0.05, 0}, {0.1, 0.05, 0}, {-0.1, 0.05, 0}};
  cloth.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.cloths = {cloth};
  Visual visual;
  visual.cloth = 0;
  visual.mesh = -1;
  visual.subdivision_levels = 0;
  const CarriedMesh mesh = carried_mesh(scene, visual);
  const Vec2f across = mesh.rest.uvs[2] - mesh.rest.uvs[0];
  EXPECT_NEAR(across.x(), 4, 1e-5);
  EXPECT_NEAR(across.y(), 2, 1e-5);
}

}  // namespace
}  // namespace pvg::test
