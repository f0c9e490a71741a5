// A scale weighs what stands on it: the reading against the mass.
#include <gtest/gtest.h>

#include "host/model/display.hpp"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

// a cube of 100 g a quarter of a millimetre above a scale; time step and tolerance as of tasks
PhysicalScene cube_on_scale() {
  PhysicalScene scene = empty_scene("scale", 0.02);
  scene.solver.velocity_tolerance = 1e-3;
  scene.solver.cg_tolerance = 1e-4;
  scene.contact.activation_distance = 0.5e-3;
  scene.rigid_bodies = {fixed_box("scale", Vec3(0.05, 0.05, 0.02), Vec3(0, 0, -0.02)),
                        box_body("cube", Vec3::Constant(0.02), 0.1 / 0.04 / 0.04 / 0.04, Vec3(0, 0, 0.02025))};
  Display display;
  display.name = "scale";
  display.rigid = 0;
  display.resolution = 1e-4;
  scene.displays = {display};
  return scene;
}

TEST(Scale, ACubeOf100GramsReads100) {
  Device device;
  Simulation simulation(device, cube_on_scale());
  EXPECT_EQ(simulation.state().reading, std::vector<double>{0});
  for (int i = 0; i < 150; ++i) simulation.step(std::vector<double>{});
  EXPECT_NEAR(simulation.state().reading[0], 0.1, 0.5e-4);
  EXPECT_EQ(shown_figures(cube_on_scale().displays[0], simulation.state().reading[0]), "100.0");
}

TEST(Scale, ReadingGoesOnFromACheckpoint) {
  Device device;
  Simulation through(device, cube_on_scale()), resumed(device, cube_on_scale());
  for (int i = 0; i < 5; ++i) through.step(std::vector<double>{});
  resumed.restore(through.checkpoint());
  EXPECT_EQ(resumed.state().reading, through.state().reading);
  for (int i = 0; i < 5; ++i) {
    through.step(std::vector<double>{});
    resumed.step(std::vector<double>{});
    EXPECT_EQ(resumed.state().reading, through.state().reading) << i;
  }
  EXPECT_GT(through.state().reading[0], 0);
}

}  // namespace
}  // namespace pvg
