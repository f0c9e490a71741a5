#include "host/capture/objects/mesh_pictures.hpp"

#include <gtest/gtest.h>

#include <array>

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

// A hollow cube with walls of 2 and 20 mm: with contact within 4 mm the thin one, on the side that is seen, is red.
TEST(MeshPictures, WallsWithinTheDistanceOfContactAreRed) {
  const auto box = [](const Vec3& low, const Vec3& high, bool is_turned) {
    TriangleMesh mesh = box_surface(high - low, {4, 4, 4});
    Vec3 own_low = mesh.points[0];
    for (const Vec3& p : mesh.points) own_low = own_low.cwiseMin(p);
    for (Vec3& p : mesh.points) p += low - own_low;
    if (is_turned)
      for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
  };
  TriangleMesh hollow = box({0, 0, 0}, {0.1, 0.1, 0.1}, false);
  const TriangleMesh inside = box({0.02, 0.002, 0.02}, {0.08, 0.08, 0.08}, true);  // thin toward -y
  const auto first = std::uint32_t(hollow.points.size());
  hollow.points.insert(hollow.points.end(), inside.points.begin(), inside.points.end());
  for (const Triangle& t : inside.triangles) hollow.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  VisualMesh visual;
  for (const Vec3& p : hollow.points) visual.points.push_back(p.cast<float>());
  visual.triangles = hollow.triangles;
  Device device;
  const auto red_pixels = [&](double reach) {
    const Picture8 picture = picture_of_thickness(device, visual, hollow, reach);
    std::array<int, 2> n = {0, 0};  // of the view from the front, and from behind
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < 640; ++x) {
        const std::uint8_t* p = &picture.rgb[std::size_t(y * picture.width + x) * 3];
        n[std::size_t(x / 320)] += p[0] > 3 * p[1] && p[0] > 3 * p[2];
      }
    return n;
  };
  EXPECT_GT(red_pixels(0.004)[0], 500);
  EXPECT_EQ(red_pixels(0.004)[1], 0);  // walls of 20 mm
  EXPECT_EQ(red_pixels(0.001)[0], 0);
}

}  // namespace
}  // namespace pvg
