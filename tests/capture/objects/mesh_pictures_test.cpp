#include "host/capture/objects/mesh_pictures.hpp"

#include <gtest/gtest.h>

#include "host/geometry/primitive_shapes.hpp"

namespace pvg {
namespace {

TEST(MeshPictures, WhatIsSeenIsLeftAndWhatIsSimulatedRight) {
  const TriangleMesh simulation = sphere_surface(0.05, 2);
  VisualMesh visual;
  for (const Vec3& p : simulation.points) visual.points.push_back(p.cast<float>());
  visual.triangles = simulation.triangles;
  visual.colors.assign(visual.points.size(), Vec3f(0.7f, 0.1f, 0.1f));
  Device device;
  const Picture8 picture = picture_of_meshes(device, visual, simulation);
  const auto pixel = [&](int x, int y) { return &picture.rgb[std::size_t(y * picture.width + x) * 3]; };
  const std::uint8_t* seen = pixel(picture.width / 4, picture.height / 2);
  const std::uint8_t* simulated = pixel(3 * picture.width / 4, picture.height / 2);
  EXPECT_GT(seen[0], seen[2] + 40);
  EXPECT_GT(simulated[2], simulated[0] + 20);
  for (const int x : {2, picture.width / 2, picture.width - 3}) {  // the sky, gray: the meshes are apart and all in it
    const std::uint8_t* sky = pixel(x, picture.height / 2);
    EXPECT_EQ(sky[0], sky[1]);
    EXPECT_EQ(sky[1], sky[2]);
  }
}

}  // namespace
}  // namespace pvg
