// Soft solids in the simulator: stiffness, weight and stitches against numbers by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "host/geometry/tet_mesh.hpp"
#include "host/physics/step/simulation.hpp"

namespace pvg {
namespace {

// a block of n[0] x n[1] x n[2] cubes with edge `size`, six tetrahedra each, corner at the origin
TetMesh block(std::array<int, 3> n, double size, bool quadratic) {
  TetMesh mesh;
  mesh.nodes_per_element = 4;
  const auto node = [&](int i, int j, int k) { return std::uint32_t(i + (n[0] + 1) * (j + (n[1] + 1) * k)); };
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i) mesh.points.push_back(size * Vec3(i, j, k));
  // Kuhn's subdivision: one tetrahedron for each order of walking along the three axes
  const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        for (int o = 0; o < 6; ++o) {
          std::array<int, 3> at = {i, j, k};
          std::array<std::uint32_t, 4> corner = {node(i, j, k), 0, 0, 0};
          for (int step = 0; step < 3; ++step) {
            ++at[orders[o][step]];
            corner[step + 1] = node(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(corner[2], corner[3]);  // odd permutations are mirrored
          mesh.elements.insert(mesh.elements.end(), corner.begin(), corner.end());
        }
  mesh.surface = boundary_triangles(mesh);
  return quadratic ? make_quadratic(mesh) : mesh;
}

RigidBody plate(const std::string& name, const Vec3& at) {
  RigidBody body;
  body.name = name;
  body.mass = 1;
  body.volume = 1e-3;
  body.inertia = Mat3::Identity() * 1e-3;
  body.is_fixed = true;
  body.pose.translation() = at;
  return body;
}

std::vector<std::uint32_t> nodes_at(const TetMesh& mesh, int axis, double value) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < mesh.points.size(); ++i)
    if (std::abs(mesh.points[i][axis] - value) < 1e-9) nodes.push_back(i);
  return nodes;
}

// node 0 of a block that falls with one face stitched; host_functions: "0" treats the device like one apart from the
// host, where all terms share a launch and the device factors
Vec3 fallen_corner(const char* host_functions, bool quadratic) {
  setenv("PVG_HOST_FUNCTIONS", host_functions, 1);
  Device device;
  unsetenv("PVG_HOST_FUNCTIONS");
  PhysicalScene scene;
  scene.name = "hanging block";
  scene.solver.velocity_tolerance = 1e-8;
  SoftBody soft;
  soft.name = "block";
  soft.mesh = block({1, 1, 2}, 0.01, quadratic);
  soft.material = {1000, 2e4, 0.4};
  scene.soft_bodies = {soft};
  scene.rigid_bodies = {plate("ceiling", Vec3(0, 0, 0.1))};
  scene.stitches = {{0, 0, nodes_at(soft.mesh, 2, 0.02), 1e5}};
  Simulation simulation(device, scene);
  for (int i = 0; i < 5; ++i) simulation.step(std::vector<double>{});
  return simulation.state().soft[0][0];
}

TEST(SoftBody, OnADeviceApartFromTheHostMovesAlike) {
  for (const bool quadratic : {false, true}) {
    const Vec3 together = fallen_corner("1", quadratic), apart = fallen_corner("0", quadratic);
    EXPECT_LT(together.z(), -1e-5);
    EXPECT_LT((together - apart).norm(), 1e-10) << (quadratic ? "10 nodes" : "4 nodes");
  }
}

TEST(SoftBody, ABarHangingByItsWeightStretchesAsTheoryTells) {
  Device device;
  PhysicalScene scene;
  scene.name = "hanging bar";
  scene.solver.time_step = 0.05;
  scene.solver.velocity_tolerance = 1e-7;
  SoftBody bar;
  bar.name = "bar";
  bar.mesh = block({2, 2, 10}, 0.01, true);
  bar.material = {1000, 2e5, 0.0};
  bar.pose.translation() = Vec3(0, 0, 1);
  scene.soft_bodies = {bar};
  scene.rigid_bodies = {plate("ceiling", Vec3(0, 0, 1.1))};
  scene.stitches = {{0, 0, nodes_at(bar.mesh, 2, 0.1), 1e6}};
  Simulation simulation(device, scene);
  for (int i = 0; i < 60; ++i) simulation.step(std::vector<double>{});
  double drop = 0;  // of the lower face, mean over its nodes
  const std::vector<std::uint32_t> lower = nodes_at(bar.mesh, 2, 0);
  for (const std::uint32_t i : lower) drop += (1 - simulation.state().soft[0][i].z()) / double(lower.size());
  // elongation rho g L^2 / (2 E); strains stay below 0.25 %, where the material is linear
  const double expected = 1000 * 9.81 * 0.01 / (2 * 2e5);
  EXPECT_NEAR(drop, expected, 0.01 * expected);
}

// A block that falls onto the floor and spreads there, once with and once without the motion of a stiffer one expected.
TEST(SoftBody, AnExpectedMotionChangesTheWayToAStepsEndNotTheEnd) {
  Device device;
  const auto falling = [](double modulus) {
    PhysicalScene scene;
    scene.name = "falling block";
    scene.solver.time_step = 0.02;
    scene.solver.velocity_tolerance = 1e-6;
    SoftBody body;
    body.name = "block";
    body.mesh = block({2, 2, 2}, 0.02, false);
    body.material = {1000, modulus, 0.4};
    body.pose.translation() = Vec3(0, 0, 0.02);
    scene.soft_bodies = {body};
    RigidBody floor = plate("floor", Vec3(0, 0, 0));
    floor.is_half_space = true;
    scene.rigid_bodies = {floor};
    return scene;
  };
  struct End {
    std::vector<std::vector<double>> motion;  // of each step
    std::vector<Vec3> points;
    int n_newton = 0;
  };
  const auto end_of = [&](double modulus, const std::vector<std::vector<double>>& expected) {
    End end;
    Simulation simulation(device, falling(modulus));
    for (std::size_t step = 0; step < 8; ++step) {
      const std::vector<double> before = simulation.checkpoint().position;
      if (step < expected.size()) simulation.expect(0, expected[step]);
      end.n_newton += simulation.step(std::vector<double>{}).newton;
      end.motion.push_back(simulation.checkpoint().position);
      for (std::size_t i = 0; i < before.size(); ++i) end.motion.back()[i] -= before[i];
    }
    end.points = simulation.state().soft[0];
    return end;
  };
  const End stiffer = end_of(2.02e4, {}), plain = end_of(2e4, {}), expecting = end_of(2e4, stiffer.motion);
  EXPECT_LT(expecting.n_newton, plain.n_newton);
  for (std::size_t i = 0; i < plain.points.size(); ++i)
    EXPECT_LT((expecting.points[i] - plain.points[i]).norm(), 1e-6);  // of a fall by 18 mm; 8 steps of 2e-8 m
  Simulation simulation(device, falling(2e4));
  EXPECT_THROW(simulation.expect(0, {0, 0, 0}), UsageError);
}

TEST(SoftBody, ABlockRestsOnTheFloorWithItsWeight) {
  Device device;
  for (const bool quadratic : {false, true}) {
    PhysicalScene scene;
    scene.name = "resting block";
    scene.solver.time_step = 0.02;
    scene.solver.velocity_tolerance = 1e-6;
    SoftBody body;
    body.name = "block";
    body.mesh = block({2, 2, 2}, 0.02, quadratic);
    body.material = {1000, 1e5, 0.45};
    body.pose.translation() = Vec3(0.003, 0.002, 0.0011);
    scene.soft_bodies = {body};
    RigidBody floor = plate("floor", Vec3(0, 0, 0));
    floor.collision.points = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    floor.collision.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.rigid_bodies = {floor};
    Simulation simulation(device, scene);
    for (int i = 0; i < 80; ++i) simulation.step(std::vector<double>{});
    double force = 0;
    for (const ContactForce& contact : simulation.state().contacts)
      force += contact.normal_force * std::abs(contact.normal.z());
    const double weight = 1000 * 64e-6 * 9.81;
    EXPECT_NEAR(force, weight, 1e-3 * weight) << (quadratic ? "10 nodes" : "4 nodes");
  }
}

}  // namespace
}  // namespace pvg
