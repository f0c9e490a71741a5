// Residuals of a channel whose time stamps are wrong by a little
#include <gtest/gtest.h>

#include <random>

#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/fit/fit_cost.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double JITTER = 1e-4;  // [s]

// A cube that slides along a rail at 5 m/s, seen with 0.1 mm of noise and 0.1 ms of jitter, which is five times as
// much.
Problem sliding_fast(const TestFolder& folder, const std::string& said) {
  folder.write("scene.yaml", R"(schema: 1
name: rail
time_step: 5 ms
gravity: [0, 0, 0]
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, collides: false}
joints:
  - {name: rail, type: prismatic, parent: base, child: cube, axis: [1, 0, 0]}
)");
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  std::string run = "t,x\n";
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.01 * i;
    run += std::to_string(t) + "," + std::to_string(5 * (t + JITTER * normal(engine)) + 1e-4 * normal(engine)) + "\n";
  }
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: x, kind: position, joint: rail, unit: m, )" +
                                     said + "}\n");
  return make_problem(folder.path / "recording.yaml");
}

double error_of(const std::string& said) {
  const TestFolder folder;
  const Problem problem = sliding_fast(folder, said);
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const FitData data = fitter.prepare(make_windows(problem, false, 0, 1), Model{});
  return rms(fit_as_it_stands(fitter, data).residual);
}

TEST(Jitter, ThatIsStatedIsPartOfTheNoise) {
  EXPECT_NEAR(error_of("noise: 0.0001, jitter: 0.1 ms"), 1, 0.15);
  EXPECT_GT(error_of("noise: 0.0001"), 3);
}

}  // namespace
}  // namespace pvg::diagnose
