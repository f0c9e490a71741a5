// Where a yield strain begins to be felt
#include "host/identify/fit/limits.hpp"

#include <gtest/gtest.h>

#include "host/identify/fit/choose_windows.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// A weight of 0.3 kg at the end of an elastic bar, of 0.4 g, without lateral contraction (E = 2 mu), falls from where
// the bar is at rest. Its greatest stretch a is where all work of the weight is in the bar,
//   m g (a - 1) / A = mu (a^2/2 + 2/a - 1/(2 a^2) - 2),  a = 1.148,
// and there, with b^2 = (2 a - 1) / a^2 across,  |dev log U| = sqrt(2/3) (ln a - ln b) = 0.120.
std::filesystem::path falling_weight(const TestFolder& folder) {
  folder.write("scene.yaml", R"(schema: 1
name: falling_weight
time_step: 2 ms
solver: {velocity_tolerance: 1e-6, integrator: bdf2}
bodies:
  - {name: frame, kind: static, shape: {box: {size: [0.05, 0.05, 0.01]}}, collides: false}
  - {name: weight, kind: rigid, shape: {box: {size: [0.04, 0.04, 0.02]}}, mass: 0.3, pose: {position: [0, 0, -0.11]}, collides: false}
  - name: bar
    kind: soft
    shape: {bar: {size: [0.1, 0.02, 0.02], divisions: [3, 1, 1], nodes_per_element: 4}}
    pose: {position: [0, 0, -0.05], rotation: [0, 90 deg, 0]}
    material: {density: 10, youngs_modulus: 100 kPa, poisson_ratio: 0}
stitches:
  - {soft: bar, rigid: frame, low: [-0.0501, -1, -1], high: [-0.0499, 1, 1], stiffness: 1e7, direction: [0, 0, 1]}
  - {soft: bar, rigid: frame, low: [-0.0501, -1, -1], high: [-0.0499, 1, 1], stiffness: 10, direction: [1, 0, 0]}
  - {soft: bar, rigid: frame, low: [-0.0501, -1, -1], high: [-0.0499, 1, 1], stiffness: 10, direction: [0, 1, 0]}
  - {soft: bar, rigid: weight, low: [0.0499, -1, -1], high: [0.0501, 1, 1], stiffness: 1e7, direction: [0, 0, 1]}
  - {soft: bar, rigid: weight, low: [0.0499, -1, -1], high: [0.0501, 1, 1], stiffness: 10, direction: [1, 0, 0]}
  - {soft: bar, rigid: weight, low: [0.0499, -1, -1], high: [0.0501, 1, 1], stiffness: 10, direction: [0, 1, 0]}
)");
  std::string run = "t,x,y,z\n";
  for (int i = 0; i <= 15; ++i)
    run += std::to_string(0.01 * i) + ",0,0," + std::to_string(-0.1 - 0.0074 * (1 - std::cos(0.365 * i))) + "\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {columns: [x, y, z], kind: marker, body: bar, point: [0.05, 0, 0], unit: m, noise: 0.0002}
)");
  return folder.path / "recording.yaml";
}

TEST(Limits, AYieldStrainBeginsAtTheGreatestStrainOfTheRuns) {
  const TestFolder folder;
  const Problem problem = make_problem(falling_weight(folder));
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const FitData data = fitter.prepare(make_windows(problem, false, 0, 1), Model{});
  std::vector<Candidate> candidates = make_candidates(problem, {});
  place_limits(fitter, data, fit_as_it_stands(fitter, data), candidates);
  const auto yield = std::find_if(candidates.begin(), candidates.end(),
                                  [](const Candidate& candidate) { return candidate.name == "plastic_yield"; });
  ASSERT_NE(yield, candidates.end());
  const Parameter& limit = yield->parameters.at(0);
  EXPECT_GT(limit.off, 0.119);
  EXPECT_LT(limit.off, 0.120 * 1.1);  // limits are tried in steps of 9 %
  EXPECT_DOUBLE_EQ(limit.high, limit.off);
  EXPECT_GT(limit.scale, 0);
}

}  // namespace
}  // namespace pvg::diagnose
