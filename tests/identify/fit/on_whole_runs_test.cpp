// What was found in short windows, measured on whole runs
#include "host/identify/fit/on_whole_runs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/identify/spindle.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double SPRING = 2.0;  // [N m/rad]

// A plate of I = 2 / 300 kg m^2 on a spring that the scene does not have, which swings from 0.1 rad for 2 s:
//   q(t) = 0.1 cos(w t),  w = sqrt(SPRING / I) = 17 rad/s
Problem swinging(const TestFolder& folder) {
  folder.write("scene.yaml", plate_on_a_spindle("5 ms"));
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.001);
  std::string run = "t,q\n";
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.01 * i;
    run += std::to_string(t) + "," + std::to_string(0.1 * std::cos(std::sqrt(SPRING * 150) * t) + noise(random)) + "\n";
  }
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, noise: 0.001}
)");
  return make_problem(folder.path / "recording.yaml");
}

struct Plate {
  TestFolder folder;
  Problem problem = swinging(folder);
  Device device;
  Predictor predictor{device, problem};
  Variant base{problem.scene.scene, {}};
  Fitter fitter{predictor, base};
  std::vector<Candidate> candidates = make_candidates(problem, {});
  // in eight windows, from a spring that is a little wrong
  Fit in_windows() {
    const auto spring =
        std::find_if(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.name == "joint_spring"; });
    Model model = model_of({&*spring});
    model.x[0] = 0.98 * SPRING;
    return fitter.fit(fitter.prepare(make_windows(problem, false, 0.25, 8), model), {model}, 6).front();
  }
};

TEST(OnWholeRuns, TheStiffnessOfASpringIsKnownFarBetterThanByWindows) {
  Plate plate;
  const Fit found = plate.in_windows();
  const auto whole = on_whole_runs(plate.fitter, plate.problem, 8, found);
  ASSERT_TRUE(whole.has_value());
  ASSERT_EQ(whole->data.windows.size(), 1u);
  const double by_windows = std::sqrt(found.covariance(0, 0)), by_run = std::sqrt(whole->fit.covariance(0, 0));
  EXPECT_LT(by_run, by_windows / 2);  // the phase of 2 s tells it, not that of 0.25 s
  EXPECT_LT(std::abs(whole->fit.model.x[0] - SPRING), 3 * by_run);
  EXPECT_NEAR(rms(whole->fit.residual), 1, 0.15);
}

TEST(OnWholeRuns, AModelThatLosesThePhaseStaysInItsWindows) {
  Plate plate;
  Fit found = plate.in_windows();
  found.model.x[0] = 2 * SPRING;
  EXPECT_FALSE(on_whole_runs(plate.fitter, plate.problem, 8, found).has_value());
}

}  // namespace
}  // namespace pvg::diagnose
