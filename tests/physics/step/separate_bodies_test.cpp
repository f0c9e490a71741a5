// Bodies that intersect at the start are moved apart, or refused.
#include "host/physics/step/separate_bodies.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

PhysicalScene pile() {
  PhysicalScene scene = empty_scene("pile", 0.01);
  scene.separates_start = true;
  scene.rigid_bodies = {fixed_box("floor", Vec3(1, 1, 0.05), Vec3(0, 0, -0.05)),
                        box_body("low", Vec3::Constant(0.05), 1000, Vec3(0, 0, 0.04)),
                        box_body("high", Vec3::Constant(0.05), 1000, Vec3(0.01, 0, 0.12))};
  return scene;
}

TEST(SeparateBodies, GoTheShorterWayAndAreThenAccepted) {
  Device device;
  PhysicalScene scene = pile();
  const std::vector<Separation> moved = separate_bodies(scene);
  ASSERT_EQ(moved.size(), 2u);
  // 10 mm out of the floor, and half the activation distance of 1 mm
  EXPECT_LE((moved[0].by - Vec3(0, 0, 0.0105)).norm(), 1e-6);
  EXPECT_LE((moved[1].by - Vec3(0, 0, 0.031)).norm(), 1e-6);
  Simulation simulation(device, pile());
  for (int i = 0; i < 5; ++i) EXPECT_GT(simulation.step(std::vector<double>{}).min_gap, 0);
}

TEST(SeparateBodies, ComeOutOfAHalfSpaceAlongItsNormal) {
  Device device;
  PhysicalScene scene = pile();
  scene.rigid_bodies[0].is_half_space = true;
  scene.rigid_bodies[0].collision = {};
  scene.rigid_bodies[0].pose.translation().setZero();
  separate_bodies(scene);
  EXPECT_NEAR(scene.rigid_bodies[1].pose.translation().z(), 0.0505, 1e-6);
  EXPECT_NO_THROW(Simulation(device, scene));
}

TEST(SeparateBodies, WithoutTheRequestOrWithoutAFreeBodyAreRefusedByName) {
  Device device;
  PhysicalScene not_asked = pile(), held = pile();
  not_asked.separates_start = false;
  held.rigid_bodies[1].is_fixed = held.rigid_bodies[2].is_fixed = true;
  held.rigid_bodies.push_back(box_body("rod", Vec3::Constant(0.03), 1000, Vec3(0, 0, 0.1)));
  Joint hinge;
  hinge.name = "hinge";
  hinge.type = Joint::Type::spherical;
  hinge.parent = 0;
  hinge.child = 3;
  hinge.parent_frame.translation() = Vec3(0, 0, 0.15);
  held.joints = {hinge};
  for (const PhysicalScene& scene : {not_asked, held}) {
    try {
      Simulation simulation(device, scene);
      FAIL() << "an intersection was accepted";
    } catch (const UsageError& e) {
      EXPECT_NE(std::string(e.what()).find("low"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace pvg
