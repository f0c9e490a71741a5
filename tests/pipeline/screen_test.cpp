// What is screened beside an effect that was found before
#include "pipeline/diagnose/screen.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/diagnose/window.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// Torque on a pendulum: q'' = u / I - k sin q, k = m l g / I, by Runge and Kutta's fourth order. The scene says
// I = 0.0626 kg m^2 and k = 16 1/s^2, a point mass at 0.6137 m; here are 0.76 kg at 0.5 m: 0.19 and 19.62.
std::string heavy_pendulum() {
  const double inertia = 0.19, k = 19.62, h = 0.005;
  const auto torque = [](double t) { return 1.2 * std::sin(6 * t) + 0.8 * std::sin(2.3 * t); };
  const auto rate_of = [&](double t, double q) { return torque(t) / inertia - k * std::sin(q); };
  std::string table = "t,q,u\n";
  double q = 0.9, w = 0;
  for (int i = 0; i <= 400; ++i) {
    const double t = i * h;
    char row[80];
    std::snprintf(row, sizeof row, "%.3f,%.9f,%.9f\n", t, q, torque(t));
    table += row;
    const double a1 = rate_of(t, q), w2 = w + h / 2 * a1, a2 = rate_of(t + h / 2, q + h / 2 * w);
    const double w3 = w + h / 2 * a2, a3 = rate_of(t + h / 2, q + h / 2 * w2);
    const double w4 = w + h * a3, a4 = rate_of(t + h, q + h * w3);
    q += h / 6 * (w + 2 * w2 + 2 * w3 + w4);
    w += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return table;
}

Problem pendulum(const TestFolder& folder) {
  folder.write("scene.yaml", R"(schema: 1
name: pendulum
time_step: 2 ms
bodies:
  - {name: motor, kind: static, shape: {box: {size: [0.02, 0.02, 0.02]}}, collides: false}
  - {name: tip, kind: rigid, shape: {box: {size: [0.02, 0.02, 0.02]}}, mass: 0.1662, pose: {position: [0, 0, -0.6137]}, collides: false}
joints:
  - {name: shaft, type: revolute, parent: motor, child: tip, axis: [0, 1, 0], drive: {mode: torque, target: 0}}
)");
  folder.write("a.csv", heavy_pendulum());
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
inputs:
  - {column: u, target: joint/shaft/torque, unit: N m}
channels:
  - {column: q, kind: position, joint: shaft, unit: rad, noise: 0.001}
)");
  return make_problem(folder.path / "recording.yaml");
}

// The mass that fits best alone is a quarter off the one that is right beside the shifted centre of mass: it may go one
// of its steps there, and the centre's best place beside it must be found all the same.
TEST(Screen, ACandidateIsBestBesideWhereTheEffectThatWasFoundCanGo) {
  const TestFolder folder;
  const Problem problem = pendulum(folder);
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const FitData data = fitter.prepare(make_windows(problem, false, 0.25, 8), Model{});
  ASSERT_EQ(data.windows.size(), 8u);
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto named = [&](const std::string& name) -> const Candidate* {
    for (const Candidate& candidate : candidates)
      if (candidate.name == name) return &candidate;
    return nullptr;
  };
  const Candidate* mass = named("retune_mass");
  const Candidate* centre = named("center_of_mass_offset");
  ASSERT_NE(mass, nullptr);
  ASSERT_NE(centre, nullptr);
  const Model guess{{mass}, Eigen::VectorXd::Constant(1, 0.4), Eigen::VectorXd::Constant(1, 0.005)};
  const Fit heavy = fitter.fit(data, {guess}, 10).front();
  ASSERT_TRUE(heavy.is_well);
  ASSERT_GT(rms(heavy.residual), 3);
  const std::vector<Screened> found = screen(fitter, data, heavy, {centre});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GT(found[0].gain, 0);
  EXPECT_NEAR(found[0].model.x[3], 0.6137 - 0.5, 0.05);  // along the rod [m]; of x nothing is wrong
}

}  // namespace
}  // namespace pvg::diagnose
