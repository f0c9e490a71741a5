// Statics of soft bodies against the theory of bars and beams: what a mesh of ten-node tetrahedra is worth.
#include "host/physics/step/static_equilibrium.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/geometry/tet_mesh.hpp"

namespace pvg {
namespace {

// a bar of n x 1 x 1 cells along x, six tetrahedra each
TetMesh bar(int n, const Vec3& cell, bool is_quadratic) {
  TetMesh mesh;
  mesh.nodes_per_element = 4;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k < 4; ++k) mesh.points.push_back(cell.cwiseProduct(Vec3(i, k % 2, k / 2)));
  const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const int strides[3] = {4, 1, 2};
  for (int i = 0; i < n; ++i)
    for (int o = 0; o < 6; ++o) {
      std::uint32_t corner[4] = {std::uint32_t(4 * i), 0, 0, 0};
      for (int step = 0; step < 3; ++step) corner[step + 1] = corner[step] + strides[orders[o][step]];
      if (o >= 3) std::swap(corner[2], corner[3]);
      mesh.elements.insert(mesh.elements.end(), corner, corner + 4);
    }
  mesh.surface = boundary_triangles(mesh);
  return is_quadratic ? make_quadratic(mesh) : mesh;
}

// One end held, the other loaded by a uniform traction; mean displacement of the loaded end. A uniform traction loads
// the three corners of a linear face alike, and of a quadratic one the three midpoints.
Vec3 pulled(Device& device, const TetMesh& mesh, const SolidMaterial& material, double length, const Vec3& force) {
  StaticProblem problem{mesh, material, {}, std::vector<Vec3>(mesh.points.size(), Vec3::Zero())};
  std::vector<double> weight(mesh.points.size(), 0);
  double area = 0;
  const bool is_quadratic = mesh.nodes_per_element == 10;
  for (std::size_t t = 0; t < mesh.surface.size(); ++t) {
    const auto [a, b, c] = mesh.surface[t];
    const Vec3 &p = mesh.points[a], &q = mesh.points[b], &r = mesh.points[c];
    // the last of a quadratic face's four triangles lies between its midpoints
    if (std::min({p(0), q(0), r(0)}) < length - 1e-9 || (is_quadratic && t % 4 != 3)) continue;
    const double third = (is_quadratic ? 4 : 1) * (q - p).cross(r - p).norm() / 6;
    for (const std::uint32_t corner : {a, b, c}) weight[corner] += third;
    area += 3 * third;
  }
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    problem.force[i] = weight[i] / area * force;
    if (mesh.points[i](0) < 1e-9) problem.held.push_back(std::uint32_t(i));
  }
  const StaticResult result = solve_static(device, problem);
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < mesh.points.size(); ++i) mean += weight[i] / area * (result.points[i] - mesh.points[i]);
  return mean;
}

// F L / (E A) at a strain of 0.05 %, Poisson's ratio 0 so that the held end does not disturb
TEST(StaticEquilibrium, ABarStretchesByHookesLaw) {
  Device device;
  const double length = 0.1, expected = 5e-5;
  for (const bool is_quadratic : {false, true}) {
    const TetMesh mesh = bar(10, Vec3::Constant(0.01), is_quadratic);
    const Vec3 u = pulled(device, mesh, {1000, 2e6, 0}, length, Vec3(2e6 * 1e-4 * expected / length, 0, 0));
    EXPECT_NEAR(u(0), expected, 2e-3 * expected);
  }
}

// Timoshenko: F L^3 / (3 E I) + F L / (k G A), one element through the thickness, cells twice as long as thick;
// a linear element locks. This is why ten nodes are the default.
TEST(StaticEquilibrium, OneLayerOfTenNodesBendsAsABeam) {
  Device device;
  const double thickness = 0.002, width = 0.006, length = 0.06, youngs_modulus = 15e6, force = 2e-4;
  for (const double nu : {0.3, 0.45}) {
    const double inertia = width * std::pow(thickness, 3) / 12;
    const double shear = youngs_modulus / (2 * (1 + nu)) * width * thickness * 5 / 6;
    const double expected = force * std::pow(length, 3) / (3 * youngs_modulus * inertia) + force * length / shear;
    const auto tip = [&](bool is_quadratic) {
      const TetMesh mesh = bar(15, Vec3(0.004, width, thickness), is_quadratic);
      return pulled(device, mesh, {1200, youngs_modulus, nu}, length, Vec3(0, 0, force))(2);
    };
    EXPECT_NEAR(tip(true) / expected, 1, 0.1) << "ten nodes, Poisson's ratio " << nu;
    EXPECT_LT(tip(false) / expected, 0.35) << "four nodes, Poisson's ratio " << nu;
  }
}

// a bending moment of F L turns a beam of E I by F L^2 / (2 E I): the end of a long thin one goes far, without rest
TEST(StaticEquilibrium, LargeDeflectionFollowsTheElastica) {
  Device device;
  // F L^2 / (E I) = 2: the tip goes 0.4935 L down and 0.1606 L back (Mattiasson 1981)
  const double thickness = 0.002, width = 0.004, length = 0.1, youngs_modulus = 10e6;
  const double force = 2 * youngs_modulus * width * std::pow(thickness, 3) / 12 / (length * length);
  const TetMesh mesh = bar(25, Vec3(0.004, width, thickness), true);
  const Vec3 u = pulled(device, mesh, {1200, youngs_modulus, 0}, length, Vec3(0, 0, force));
  EXPECT_NEAR(u(2) / length, 0.4935, 0.02 * 0.4935);
  EXPECT_NEAR(-u(0) / length, 0.1606, 0.04 * 0.1606);
}

TEST(StaticEquilibrium, ABodyThatNothingHoldsIsRefused) {
  Device device;
  const TetMesh mesh = bar(1, Vec3::Constant(0.01), true);
  StaticProblem problem{mesh, {}, {}, std::vector<Vec3>(mesh.points.size(), Vec3(1, 0, 0))};
  EXPECT_THROW(solve_static(device, problem), Failure);
  problem.force.pop_back();
  EXPECT_THROW(solve_static(device, problem), UsageError);
}

}  // namespace
}  // namespace pvg
