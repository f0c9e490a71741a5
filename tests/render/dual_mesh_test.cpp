// The dual mesh on the device against the same sums on the host.
#include "host/render/dual_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

namespace pvg {
namespace {

// a bent strip of n squares, and one node that no triangle names
struct Strip {
  std::vector<Vec3> nodes = {Vec3(9, 9, 9)};
  std::vector<Triangle> triangles;
  explicit Strip(std::uint32_t n) {
    for (std::uint32_t i = 0; i <= n; ++i)
      for (const double y : {0.0, 1.0}) nodes.push_back(Vec3(0.1 * i, 0.1 * y, 0.05 * std::sin(i + y)));
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = 1 + 2 * i;
      triangles.push_back({a, a + 2, a + 3});
      triangles.push_back({a, a + 3, a + 1});
    }
  }
};

DualMesh dual_mesh(Device& device, const Subdivision& fine) {
  std::vector<std::uint32_t> own(fine.weights.n_rows());
  std::iota(own.begin(), own.end(), 0u);
  return DualMesh(device, fine.weights, fine.triangles, own);
}

TEST(DualMesh, PointsAndNormalsAreTheHostsForAwkwardSizes) {
  Device device;
  for (const std::uint32_t n : {0, 1, 3, 257, 1000}) {
    const Strip strip(n);
    const Subdivision fine = subdivide_loop(strip.nodes.size(), strip.triangles, 1);
    DualMesh mesh = dual_mesh(device, fine);
    const std::uint32_t first = 5;
    std::vector<Vertex> marked(first + mesh.n_vertices());
    for (Vertex& v : marked) v = {{7, 7, 7}, {7, 7, 7}, {0.25f, 0.5f}};
    Buffer<Vertex> vertices(device, marked, "vertices");
    mesh.follow(strip.nodes, vertices, first);
    const std::vector<Vertex> result = vertices.read();

    const std::vector<Vec3> points = multiply(fine.weights, strip.nodes);
    std::vector<Vec3> normals(points.size(), Vec3::Zero());
    for (const auto& [a, b, c] : fine.triangles)
      for (const std::uint32_t corner : {a, b, c})
        normals[corner] += (points[b] - points[a]).cross(points[c] - points[a]);
    for (std::uint32_t i = 0; i < first; ++i) EXPECT_EQ(result[i].point[0], 7) << "written before the first vertex";
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vertex& v = result[first + i];
      ASSERT_LE((Eigen::Map<const Vec3f>(v.point).cast<double>() - points[i]).norm(), 1e-5 + 2e-7 * points[i].norm());
      ASSERT_LE((Eigen::Map<const Vec3f>(v.normal).cast<double>() - normals[i].normalized()).norm(), 2e-3);
      ASSERT_EQ(v.uv[0], 0.25f);
      ASSERT_EQ(v.uv[1], 0.5f);
    }
  }
}

TEST(DualMesh, AFlatPieceLooksUpAndTurnsWithItsNodes) {
  Device device;
  std::vector<Vec3> nodes = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
  DualMesh mesh = dual_mesh(device, subdivide_loop(4, triangles, 2));
  Buffer<Vertex> vertices(device, std::vector<Vertex>(mesh.n_vertices()), "vertices");
  mesh.follow(nodes, vertices, 0);
  for (const Vertex& v : vertices.read()) EXPECT_EQ(v.normal[2], 1);
  for (Vec3& x : nodes) x = Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()) * x;
  mesh.follow(nodes, vertices, 0);
  for (const Vertex& v : vertices.read()) EXPECT_NEAR(v.normal[0], 1, 1e-6);
}

TEST(DualMesh, RefusesTheWrongNumberOfNodes) {
  Device device;
  const std::vector<Triangle> triangles = {{0, 1, 2}};
  DualMesh mesh = dual_mesh(device, subdivide_loop(3, triangles, 1));
  Buffer<Vertex> vertices(device, std::vector<Vertex>(mesh.n_vertices()), "vertices");
  EXPECT_THROW(mesh.follow(std::vector<Vec3>(4), vertices, 0), std::logic_error);
  EXPECT_THROW(mesh.follow(std::vector<Vec3>(3), vertices, 1), std::logic_error);
}

}  // namespace
}  // namespace pvg
