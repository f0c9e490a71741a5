#include "host/model/camera_inside.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/box_mesh.hpp"

namespace pvg {
namespace {

// a box of 0.2 m about (1, 0, 0), which stands still, and a camera in its middle
Scene box_around_camera() {
  Scene scene;
  RigidBody body;
  body.name = "crate";
  body.pose.translation() = Vec3(1, 0, 0);
  scene.rigid_bodies.push_back(body);
  const TriangleMesh box = test::box({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1});
  VisualMesh mesh;
  for (const Vec3& point : box.points) mesh.points.push_back(point.cast<float>());
  mesh.triangles = box.triangles;
  scene.visual_meshes.push_back(mesh);
  scene.materials.emplace_back();
  Visual visual;
  visual.name = "crate/2";
  visual.mesh = visual.material = visual.rigid = 0;
  scene.visuals.push_back(visual);
  Camera camera;
  camera.name = "front";
  camera.pose.translation() = Vec3(1.05, 0.02, 0);
  scene.cameras.push_back(camera);
  return scene;
}

TEST(CameraInside, OfAnOpaqueBodyIsNamedWithIt) {
  const Scene scene = box_around_camera();
  const std::vector<std::string> sentences = cameras_inside(scene);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_NE(sentences[0].find("camera front is inside of `crate`"), std::string::npos) << sentences[0];
}

TEST(CameraInside, WhatMaySurroundACameraIsNoFault) {
  Scene outside = box_around_camera();
  outside.cameras[0].pose.translation() = Vec3(1.2, 0, 0);
  EXPECT_TRUE(cameras_inside(outside).empty());
  Scene glass = box_around_camera();
  glass.materials[0].kind = VisualMaterial::Kind::dielectric;
  EXPECT_TRUE(cameras_inside(glass).empty());
  Scene room = box_around_camera();
  room.visuals[0].rigid = -1;
  room.visuals[0].pose.translation() = Vec3(1, 0, 0);
  EXPECT_TRUE(cameras_inside(room).empty());
  Scene open = box_around_camera();
  open.visual_meshes[0].triangles.pop_back();
  EXPECT_TRUE(cameras_inside(open).empty());
}

}  // namespace
}  // namespace pvg
