// Robots at full size: two arms with two soft grippers in one scene, a few steps of it.
#include <gtest/gtest.h>

#include "host/load/scene_file.hpp"
#include "host/physics/energies/system.hpp"
#include "host/physics/step/simulation.hpp"

namespace pvg {
namespace {

TEST(TwoArms, AreOneGroupEachAndMoveWithoutIntersections) {
  const SceneRun run = load_scene_run(std::string(PVG_DATA_FOLDER) + "/scenes/two_arms.yaml");
  EXPECT_GE(n_bodies(run.scene), 25u);
  // one exact block per robot with its fingers, one for the cube
  EXPECT_EQ(make_system(std::vector<PhysicalScene>{run.scene}).group_world.size(), 3u);
  Device device;
  Simulation simulation(device, run.scene);
  std::vector<double> targets;
  for (int step = 1; step <= 10; ++step) {
    targets = run.targets_at(step * run.scene.solver.time_step);
    ASSERT_EQ(targets.size(), 18u);
    const StepReport report = simulation.step(targets);
    ASSERT_GT(report.min_gap, 0) << step;
    ASSERT_EQ(report.retries, 0) << step;
  }
  // the arms follow: they are stiff against how fast the targets go, and carry their own weight
  std::size_t driven = 0;
  for (std::size_t j = 0; j < run.scene.joints.size(); ++j)
    if (is_driven(run.scene.joints[j])) {
      EXPECT_NEAR(simulation.state().joint_position[j], targets[driven], 5e-3) << run.scene.joints[j].name;
      ++driven;
    }
}

}  // namespace
}  // namespace pvg
