// Sums of contact forces against weights known by hand.
#include "host/physics/energies/body_forces.hpp"

#include <gtest/gtest.h>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg::body_forces_test {
namespace {

// 1 kg on 1 kg on the floor: each feels its own weight back, the floor feels both
TEST(BodyForces, OfARestingStackAreItsWeights) {
  Device device;
  PhysicalScene scene = empty_scene("stack", 0.01);
  scene.rigid_bodies = {fixed_box("floor", Vec3(0.5, 0.5, 0.05), Vec3(0, 0, -0.05)),
                        box_body("low", Vec3::Constant(0.05), 1000, Vec3(0, 0, 0.0506)),
                        box_body("high", Vec3::Constant(0.05), 1000, Vec3(0.01, 0, 0.1512))};
  Simulation simulation(device, scene);
  for (int i = 0; i < 60; ++i) simulation.step(std::vector<double>{});
  const WorldState& state = simulation.state();
  ASSERT_EQ(state.body_force.size(), 3u);
  const double weight = 9.81;
  for (const auto& [body, up] : {std::pair(0, -2 * weight), {1, weight}, {2, weight}}) {
    EXPECT_LE((state.body_force[body].force - Vec3(0, 0, up)).norm(), 2e-3 * weight) << body;
    if (body > 0) {
      EXPECT_LE(state.body_force[body].torque.norm(), 1e-3) << body;
    }
  }
  ASSERT_EQ(state.pair_force.size(), 2u);  // sorted: floor and low, low and high
  EXPECT_EQ(state.pair_force[0].first, 0);
  EXPECT_EQ(state.pair_force[0].second, 1);
  EXPECT_NEAR(state.pair_force[0].normal.z(), -2 * weight, 2e-3 * weight);
  EXPECT_NEAR(state.pair_force[1].normal.z(), -weight, 2e-3 * weight);
}

// two contacts by hand: pushes along +z at x = +-1 with 3 N and 1 N, the second with friction of 2 N along y
TEST(BodyForces, AddUpWithTheirLevers) {
  PhysicalScene scene = empty_scene("levers", 0.01);
  scene.rigid_bodies = {box_body("a", Vec3::Ones(), 1, Vec3::Zero()), box_body("b", Vec3::Ones(), 1, Vec3(0, 0, 5))};
  scene.rigid_bodies[0].center_of_mass = Vec3(0, 0, 1);
  WorldState state;
  for (const RigidBody& body : scene.rigid_bodies) state.rigid.push_back(body.pose.matrix().topRows<3>());
  ContactForce right, left;
  right.first = 0, right.second = 1, right.point = Vec3(1, 0, 1), right.normal = Vec3::UnitZ(), right.normal_force = 3;
  left.first = 1, left.second = 0, left.point = Vec3(-1, 0, 1), left.normal = -Vec3::UnitZ(), left.normal_force = 1;
  left.friction_force = Vec3(0, 2, 0);
  state.contacts = {right, left};
  sum_forces(scene, state);
  EXPECT_EQ(state.body_force[0].force, Vec3(0, -2, 4));
  EXPECT_EQ(state.body_force[0].torque, Vec3(0, -2, 2));  // x r: (1,0,0)x(0,0,3) + (-1,0,0)x(0,-2,1)
  EXPECT_EQ(state.body_force[1].force, Vec3(0, 2, -4));
  ASSERT_EQ(state.pair_force.size(), 1u);
  EXPECT_EQ(state.pair_force[0].normal, Vec3(0, 0, 4));
  EXPECT_EQ(state.pair_force[0].friction, Vec3(0, -2, 0));
}

}  // namespace
}  // namespace pvg::body_forces_test
