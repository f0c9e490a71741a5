// Numbers of an effect with a kink, of which the chosen time step is wrong
#include "host/identify/search/finer_steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/identify/spindle.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double FRICTION = 0.01;  // [N m]

// A plate of I = 2 / 300 kg m^2 that turns at 1 rad/s, is braked by FRICTION and stands still after I / FRICTION =
// 0.667 s:
//   q(t) = t - FRICTION t^2 / (2 I)
Problem braked(const TestFolder& folder, const std::string& time_step) {
  folder.write("scene.yaml", plate_on_a_spindle(time_step));
  const double inertia = 2.0 / 300, stop = inertia / FRICTION;
  std::string run = "t,q\n";
  for (int i = 0; i <= 100; ++i) {
    const double t = std::min(0.01 * i, stop);
    run += std::to_string(0.01 * i) + "," + std::to_string(t - FRICTION / (2 * inertia) * t * t) + "\n";
  }
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit, initial: {joint/spindle/position: 0, joint/spindle/velocity: 1}}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, noise: 0.0001}
)");
  return make_problem(folder.path / "recording.yaml");
}

struct Braked {
  explicit Braked(const std::string& time_step) : problem(braked(folder, time_step)) {
    flow.base.scene = problem.scene.scene;
    const auto friction = std::find_if(candidates.begin(), candidates.end(),
                                       [](const Candidate& c) { return c.name == "joint_coulomb_friction"; });
    Model model = model_of({&*friction});
    model.x[0] = FRICTION;
    const FitData data = flow.fitter.prepare(make_windows(problem, false, 0, 1), model);
    selected.fits = flow.fitter.fit(data, {model}, 4);
    selected.windows = data.windows;
  }
  double found() const { return selected.fits.back().model.x[0]; }
  double deviation() const { return std::sqrt(selected.fits.back().covariance(0, 0)); }
  TestFolder folder;
  Problem problem;
  Device device;
  Settings settings;
  Workflow flow{device, problem, settings};
  std::vector<Candidate> candidates = make_candidates(problem, {});
  Selection selected;
};

TEST(FinerSteps, FrictionIsNearerToTheTruthWhereTheStepWasTooLong) {
  Braked plate("50 ms");
  const double before = plate.found() - FRICTION;
  use_finer_steps(plate.flow, plate.selected);
  EXPECT_LT(plate.flow.base.scene.solver.time_step, 0.03);
  EXPECT_LT(std::abs(plate.found() - FRICTION), std::abs(before) / 2);
  EXPECT_LT(std::abs(plate.found() - FRICTION), 2 * plate.deviation());
}

TEST(FinerSteps, AStepThatIsShortEnoughStays) {
  Braked plate("4 ms");
  const double before = plate.found();
  use_finer_steps(plate.flow, plate.selected);
  EXPECT_EQ(plate.flow.base.scene.solver.time_step, 4e-3);
  EXPECT_EQ(plate.found(), before);
}

}  // namespace
}  // namespace pvg::diagnose
