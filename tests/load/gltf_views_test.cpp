// Cameras and punctual lights of glTF files against numbers by hand.
#include "host/load/gltf_views.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

// turned so that -z of the node looks along +x, y stays up (z after the change of axes)
Eigen::Affine3d looking_along_x() {
  Eigen::Affine3d node = Eigen::Affine3d::Identity();
  node.linear().col(0) = -Vec3::UnitY();
  node.linear().col(1) = Vec3::UnitZ();
  node.linear().col(2) = -Vec3::UnitX();
  node.linear() *= 2;  // a node's scale says nothing
  node.translation() = Vec3(1, 2, 3);
  return node;
}

TEST(GltfViews, ACameraLooksAlongMinusZWithYUp) {
  tinygltf::Camera from;
  from.type = "perspective";
  from.perspective.yfov = M_PI / 2;
  from.perspective.aspectRatio = 2;
  const Camera camera = read_gltf_camera(from, looking_along_x(), "eye", "a.glb");
  EXPECT_EQ(camera.height, 360);
  EXPECT_EQ(camera.width, 720);
  EXPECT_NEAR(camera.fy, 180, 1e-9);
  EXPECT_LT((camera.pose.linear().col(2) - Vec3::UnitX()).norm(), 1e-12);  // forward
  EXPECT_LT((camera.pose.linear().col(1) + Vec3::UnitZ()).norm(), 1e-12);  // down
  EXPECT_LT((camera.pose.linear().col(0) + Vec3::UnitY()).norm(), 1e-12);  // right
  EXPECT_LT((camera.pose.translation() - Vec3(1, 2, 3)).norm(), 1e-12);
  from.perspective.yfov = 4;
  expect_error<UsageError>([&] { read_gltf_camera(from, looking_along_x(), "eye", "a.glb"); },
                           {"a.glb", "`eye`", "yfov"});
}

tinygltf::Light light_of(const std::string& type) {
  tinygltf::Light light;
  light.type = type;
  light.intensity = 50;
  light.color = {1, 0.5, 0};
  return light;
}

TEST(GltfViews, LightsBringWhatTheySay) {
  const auto read = [](const tinygltf::Light& light) {
    return read_gltf_light(light, looking_along_x(), Vec3(4, 0, 0), 10, "lamp", "a.glb");
  };
  // candela = W/sr: L pi r^2
  const SphereLight point = read(light_of("point"));
  EXPECT_NEAR(double(point.radiance.x()) * M_PI * point.radius * point.radius, 50, 1e-3);
  EXPECT_NEAR(point.radiance.y(), 0.5f * point.radiance.x(), 1);
  EXPECT_LE(point.radius, 0.0101);
  EXPECT_GT(point.outer_angle, M_PI);
  // lux at the middle: L pi (r / d)^2, light comes from -x
  const SphereLight sun = read(light_of("directional"));
  const double away = (sun.center - Vec3(4, 0, 0)).norm();
  EXPECT_NEAR(double(sun.radiance.x()) * M_PI * std::pow(sun.radius / away, 2), 50, 1e-3);
  EXPECT_LT(sun.center.x(), -100);
  // its cone holds all rays from the disc to what is lit
  EXPECT_GT(sun.inner_angle, (sun.radius + 5) / away);
  tinygltf::Light spot = light_of("spot");
  spot.spot.innerConeAngle = 0.1;
  spot.spot.outerConeAngle = 0.3;
  EXPECT_EQ(read(spot).outer_angle, 0.3);
  EXPECT_LT((read(spot).direction - Vec3::UnitX()).norm(), 1e-12);
  spot.spot.outerConeAngle = 0.05;
  expect_error<UsageError>([&] { read(spot); }, {"a.glb", "`lamp`", "outerConeAngle"});
  expect_error<UsageError>([&] { read(light_of("area")); }, {"`lamp`", "`area`"});
}

}  // namespace
}  // namespace pvg
