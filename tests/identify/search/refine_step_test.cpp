// A time step that is fine for the scene as it stands and too coarse for what was found
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/identify/search/workflow.hpp"
#include "tests/identify/driven_arm.hpp"

namespace pvg::diagnose {
namespace {

// A drive of 2000 N m/rad follows a sine of 1.5 Hz as if it were held: implicit Euler with steps of 5 ms shows no
// error. One of 20 N m/rad resonates at 4.6 Hz, which implicit Euler damps.
Problem follower(const TestFolder& folder) {
  folder.write("scene.yaml", driven_arm("5 ms", "{stiffness: 2000, damping: 0.6, target: 0}"));
  std::string run = "t,command,q\n";
  for (int i = 0; i < 60; ++i) {
    const std::string c = std::to_string(0.3 * std::sin(2 * M_PI * 1.5 * 0.01 * i));
    run += std::to_string(0.01 * i) + "," + c + "," + c + "\n";
  }
  write_driven_recording(folder, run);
  return make_problem(folder.path / "recording.yaml");
}

TEST(Workflow, TheTimeStepIsComparedAgainAtWhatWasFound) {
  const TestFolder folder;
  Problem problem = follower(folder);
  Device device;
  const Settings settings;
  Workflow flow(device, problem, settings);
  flow.base.scene = problem.scene.scene;
  flow.base.scene.solver.time_step = 5e-3;
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto stiffness = std::find_if(candidates.begin(), candidates.end(),
                                      [](const Candidate& c) { return c.name == "retune_drive_stiffness"; });
  ASSERT_NE(stiffness, candidates.end());
  const Model soft{{&*stiffness}, Eigen::VectorXd::Constant(1, 20), Eigen::VectorXd::Ones(1)};
  EXPECT_TRUE(flow.refine_step(soft));
  EXPECT_EQ(flow.base.scene.solver.integrator, SolverSettings::Integrator::bdf2);
  ASSERT_EQ(flow.notes.size(), 1u);
  EXPECT_FALSE(flow.refine_step(soft)) << "once";
}

TEST(Workflow, ATimeStepThatIsFineStays) {
  const TestFolder folder;
  Problem problem = follower(folder);
  Device device;
  const Settings settings;
  Workflow flow(device, problem, settings);
  flow.base.scene = problem.scene.scene;
  EXPECT_FALSE(flow.refine_step(Model{}));
  EXPECT_EQ(flow.base.scene.solver.time_step, 5e-3);
}

}  // namespace
}  // namespace pvg::diagnose
