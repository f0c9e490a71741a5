// Friction of whole bodies against Coulomb's law: what sticks rests, what slides is braked by mu times the normal
// force, and what contacts remember survives checkpoints, failed steps and company.
#include "host/physics/contact/friction_anchors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

constexpr double G = 9.81;

// A cube of 0.1 m on a floor, clear of the diagonals of its faces; gravity is tilted as on a slope.
PhysicalScene cube_on_slope(double tangent, double friction) {
  PhysicalScene scene = empty_scene("slope", 0.01);
  scene.gravity = G * Vec3(tangent, 0, -1).normalized();
  scene.solver.velocity_tolerance = 1e-6;
  scene.rigid_bodies = {box_body("cube", Vec3::Constant(0.05), 1000, Vec3(0, -0.7, 0.0509)),
                        fixed_box("floor", Vec3(2, 2, 0.1), Vec3(0, 0, -0.1))};
  for (RigidBody& body : scene.rigid_bodies) body.friction = friction;
  return scene;
}

void run(Simulation& simulation, int n_steps) {
  for (int i = 0; i < n_steps; ++i) simulation.step(std::vector<double>{});
}
double place(const Simulation& simulation, std::size_t world = 0) { return simulation.state(world).rigid[0](0, 3); }

Friction row(u32 site, const Vec3& normal) {
  Friction row{};
  row.site[0] = site;
  row.friction_velocity = 1e-3;
  Eigen::Map<Vec3>(row.normal) = normal;
  return row;
}

// Rows that lie on the device get their anchors there, and lose nothing by it.
TEST(FrictionAnchors, AreJoinedWithTheRowsOnTheDevice) {
  constexpr u32 N = 257;
  Device device;
  Program program(device, "contact/contact.cl");
  Kernel anchor_friction = program.kernel("anchor_friction");
  std::vector<Friction> rows;
  std::vector<double> anchors;
  for (u32 i = 0; i < N; ++i) {
    rows.push_back(row(i, Vec3(0.6, 0, 0.8)));
    rows.back().site[3] = 7 * i;
    rows.back().normal_force = 0.5 * i;
    for (int k = 0; k < 3; ++k) anchors.push_back(1e-6 * i - k);
  }
  Buffer<Friction> joined(device, N, "joined");
  Buffer<u32> sites(device, 4 * N, "sites");
  anchor_friction(N, N, Buffer<Friction>(device, rows, "lagged friction"), Buffer<double>(device, anchors, "anchors"),
                  joined, sites);
  const std::vector<Friction> found = joined.read();
  const std::vector<u32> found_sites = sites.read();
  for (u32 i = 0; i < N; ++i) {
    std::copy_n(&anchors[3 * i], 3, rows[i].anchor);
    EXPECT_EQ(std::memcmp(&found[i], &rows[i], sizeof(Friction)), 0) << i;
    EXPECT_EQ(found_sites[4 * i], i);
    EXPECT_EQ(found_sites[4 * i + 3], 7 * i);
  }
}

TEST(FrictionAnchors, GoToTheRowsOfTheirPairsAndLieInTheirTangentPlanes) {
  const std::vector<Friction> old = {row(5, Vec3::UnitZ()), row(2, Vec3::UnitZ())};
  const std::vector<FrictionAnchor> anchors = anchors_of(old, std::vector<double>{0.5, 0.25, 0, -1, 0, 0});
  std::vector<Friction> rows = {row(2, Vec3::UnitY()), row(5, Vec3::UnitX()), row(3, Vec3::UnitX())};
  attach_anchors(anchors, 0.01, rows);
  const auto anchor = [&](int i) { return Vec3(Eigen::Map<const Vec3>(rows[i].anchor)); };
  EXPECT_LT((anchor(0) - 1e-5 * Vec3(-1, 0, 0)).norm(), 1e-20);
  EXPECT_LT((anchor(1) - 1e-5 * Vec3(0, 0.25, 0)).norm(), 1e-20);
  EXPECT_EQ(anchor(2), Vec3::Zero());
}

TEST(FrictionAnchors, AStickingCubeDoesNotCreep) {
  Device device;
  Simulation simulation(device, cube_on_slope(0.5, 0.51));
  run(simulation, 40);
  const double start = place(simulation);
  run(simulation, 20);
  // without anchors it would creep at epsilon_v (1 - sqrt(1 - 0.5 / 0.51)) = 9e-5 m/s, by 1.7e-5 m
  EXPECT_NEAR(place(simulation), start, 1e-9);
}

TEST(FrictionAnchors, ACubeSlidesBelowTheCriticalFriction) {
  Device device;
  Simulation simulation(device, cube_on_slope(0.5, 0.49));
  run(simulation, 40);
  const double x0 = place(simulation);
  run(simulation, 10);
  const double x1 = place(simulation);
  run(simulation, 10);
  const double a = G * (0.5 - 0.49) / std::sqrt(1.25), measured = (place(simulation) - 2 * x1 + x0) / 0.01;
  EXPECT_NEAR(measured, a, 1e-3 * a);
}

TEST(FrictionAnchors, FrictionStopsACubeWhereCoulombSays) {
  Device device;
  PhysicalScene scene = cube_on_slope(0, 0.5);
  const double h = 0.0025, v = 0.5;
  scene.solver.time_step = h;
  scene.rigid_bodies[0].velocity = Vec3(v, 0, 0);
  Simulation simulation(device, scene);
  run(simulation, 60);
  // implicit Euler: the speed after n steps is v - n mu g h
  double way = 0;
  for (double speed = v - 0.5 * G * h; speed > 0; speed -= 0.5 * G * h) way += h * speed;
  EXPECT_NEAR(place(simulation), way, 0.01 * way);
}

// A plate on a rail drags a soft block over the floor: friction is mu times the normal force in every step.
TEST(FrictionAnchors, AShearedBlockIsBrakedByTheCoefficientTimesItsNormalForce) {
  Device device;
  PhysicalScene scene = cube_on_slope(0, 0.6);
  scene.contact.activation_distance = 5e-4;
  scene.rigid_bodies[1].friction = 0.6;
  scene.rigid_bodies[0] = box_body("plate", Vec3(0.02, 0.02, 0.005), 1000, Vec3(0.3, -0.7, 0.03));
  scene.rigid_bodies[0].collision = {};
  RigidBody post = fixed_box("post", Vec3::Constant(0.01), Vec3(0.3, -0.7, 0.03));
  post.collision = {};
  scene.rigid_bodies.push_back(post);
  Joint rail;
  rail.name = "rail";
  rail.type = Joint::Type::prismatic;
  rail.parent = 2;
  rail.child = 0;
  rail.axis = Vec3::UnitX();
  rail.drive.stiffness = 1e5;
  scene.joints = {rail};
  SoftBody block;
  block.name = "block";
  block.friction = 0.6;
  block.material = {1000, 1e5, 0.4};
  // one cube of 20 mm as six tetrahedra, a little above the floor: the plate presses it down by gravity alone
  for (int i = 0; i < 8; ++i)
    block.mesh.points.push_back(0.02 * Vec3(i & 1, i >> 1 & 1, i >> 2) + Vec3(0.29, -0.71, 4e-4));
  block.mesh.nodes_per_element = 4;
  block.mesh.elements = {0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7};
  block.mesh.surface = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                        {2, 7, 3}, {2, 6, 7}, {0, 6, 2}, {0, 4, 6}, {1, 3, 7}, {1, 7, 5}};
  scene.soft_bodies = {block};
  Stitch stitch;
  stitch.soft = 0;
  stitch.rigid = 0;
  stitch.nodes = {4, 5, 6, 7};
  stitch.stiffness = 1e4;
  scene.stitches = {stitch};
  Simulation simulation(device, scene);
  for (int i = 1; i <= 40; ++i) {
    simulation.step({0.0005 * i});  // 50 mm/s
    Vec3 friction = Vec3::Zero(), normal = Vec3::Zero();
    for (const ContactForce& c : simulation.state().contacts) {
      friction += c.friction_force;
      normal += c.normal_force * c.normal;
    }
    if (i < 20) continue;  // sinks and shears until it slides
    ASSERT_GT(normal.norm(), 0.01);
    EXPECT_NEAR(friction.norm() / normal.norm(), 0.6, 1e-3) << "step " << i;
  }
}

TEST(FrictionAnchors, ACheckpointGoesOnWithTheSameBits) {
  Device device;
  const PhysicalScene scene = cube_on_slope(0.5, 0.6);
  Simulation through(device, scene), resumed(device, scene), forgetful(device, scene);
  run(through, 30);
  Checkpoint middle = through.checkpoint();
  ASSERT_FALSE(middle.anchors[0].empty());
  run(through, 5);
  resumed.restore(middle);
  run(resumed, 5);
  EXPECT_EQ(through.state().rigid[0], resumed.state().rigid[0]);
  middle.anchors[0].clear();
  forgetful.restore(middle);
  run(forgetful, 5);
  EXPECT_NE(through.state().rigid[0], forgetful.state().rigid[0]);
}

TEST(FrictionAnchors, AFailedStepLeavesThemAsTheyWere) {
  Device device;
  PhysicalScene scene = cube_on_slope(0.5, 0.6);
  // a second cube hits the sticking one after 0.32 s
  scene.rigid_bodies.push_back(box_body("hammer", Vec3::Constant(0.05), 1000, Vec3(0, -0.7, 0.63)));
  scene.gravity = G * Vec3(0, 0, -1);
  scene.solver.max_newton = 4;
  scene.solver.max_step_halvings = 0;
  Simulation simulation(device, scene);
  for (int i = 0; i < 60; ++i) {
    const Checkpoint before = simulation.checkpoint();
    try {
      run(simulation, 1);
    } catch (const StepFailure&) {
      const Checkpoint after = simulation.checkpoint();
      ASSERT_FALSE(before.anchors[0].empty());
      ASSERT_EQ(before.anchors[0].size(), after.anchors[0].size());
      for (std::size_t k = 0; k < before.anchors[0].size(); ++k) {
        EXPECT_EQ(before.anchors[0][k].pair, after.anchors[0][k].pair);
        EXPECT_EQ(before.anchors[0][k].strain, after.anchors[0][k].strain);
      }
      return;
    }
  }
  FAIL() << "the impact was expected to need more than four iterations";
}

TEST(FrictionAnchors, AWorldThatSlidesDoesNotChangeTheBitsOfOneThatSticks) {
  Device device;
  const std::vector<PhysicalScene> both = {cube_on_slope(0.5, 0.4), cube_on_slope(0.5, 0.6)};
  Simulation together(device, both), alone(device, both[1]);
  const std::vector<std::vector<double>> targets(2);
  for (int i = 0; i < 15; ++i) {
    together.step(targets);
    alone.step(targets[1]);
  }
  EXPECT_EQ(together.state(1).rigid[0], alone.state().rigid[0]);
}

}  // namespace
}  // namespace pvg
