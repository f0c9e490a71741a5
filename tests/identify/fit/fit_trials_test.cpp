// What a step of a fit simulates
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "host/identify/fit/fit.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// A ball of 0.2 kg that is thrown, beside a force of 0.1 N:  x(t) = v t + a t^2 / 2 is linear in all that is fitted.
Problem thrown(const TestFolder& folder) {
  folder.write("scene.yaml", R"(schema: 1
name: thrown
time_step: 5 ms
bodies:
  - {name: ball, kind: rigid, shape: {sphere: {radius: 0.04, subdivisions: 1}}, mass: 0.2, collides: false}
)");
  std::string run = "t,x,y,z\n";
  for (int i = 0; i <= 40; ++i) {
    const double t = 0.01 * i;
    run += std::to_string(t) + "," + std::to_string(t + 0.5 * 0.1 / 0.2 * t * t) + ",0," +
           std::to_string(2 * t - 0.5 * 9.81 * t * t) + "\n";
  }
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {columns: [x, y, z], kind: position, body: ball, unit: m, noise: 0.0005}
)");
  return make_problem(folder.path / "recording.yaml");
}

TEST(FitTrials, DampedStepsAreNotTriedWhereTheFullOneComesOutAsPredicted) {
  const TestFolder folder;
  const Problem problem = thrown(folder);
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto force =
      std::find_if(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.name == "constant_force"; });
  ASSERT_NE(force, candidates.end());
  const FitData data = fitter.prepare(make_windows(problem, false, 0, 1), Model{});
  ASSERT_EQ(data.windows.size(), 1u);
  std::vector<Fit> fits = fitter.begin(data, {model_of({&*force})});
  const std::size_t before = predictor.n_simulations();
  fitter.improve(data, fits, 1);
  EXPECT_NEAR(fits[0].model.x[0], 0.1, 1e-3);
  const std::size_t slopes = 3 + data.windows[0].unknowns.size();  // of the force and of the start
  EXPECT_EQ(predictor.n_simulations() - before, slopes + 1);
}

}  // namespace
}  // namespace pvg::diagnose
