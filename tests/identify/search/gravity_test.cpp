// Gravity that is far from what the scene says
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/search/round.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double GRAVITY = 6.15;  // [m/s^2], the scene says 9.81

// A throw of a ball, seen with a noise of 1 mm.
std::string thrown(double vx, double vz, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0, 1e-3);
  std::string table = "t,x,y,z\n";
  for (int i = 0; i <= 60; ++i) {
    const double t = 0.01 * i;
    table += std::to_string(t) + "," + std::to_string(vx * t + noise(engine)) + "," + std::to_string(noise(engine)) +
             "," + std::to_string(1 + vz * t - GRAVITY * t * t / 2 + noise(engine)) + "\n";
  }
  return table;
}

// On one ball a constant force says the same, with two numbers more and a good part of the weight. Bounds of 10 per
// cent around 9.81 m/s^2 left the force alone.
TEST(Gravity, FarOffIsNamedTogetherWithAConstantForce) {
  const TestFolder folder;
  folder.write("scene.yaml", R"(schema: 1
name: flight
time_step: 5 ms
bodies:
  - {name: ball, kind: rigid, shape: {sphere: {radius: 0.04, subdivisions: 1}}, mass: 0.4, collides: false}
)");
  folder.write("a.csv", thrown(3, 2, 1));
  folder.write("b.csv", thrown(-2, 3, 2));
  folder.write("c.csv", thrown(4, 1, 3));
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
  - {file: b.csv, role: fit}
  - {file: c.csv, role: fit}
channels:
  - {columns: [x, y, z], kind: position, body: ball, unit: m, noise: 0.001}
)");
  Problem problem = make_problem(folder.path / "recording.yaml");
  Device device;
  const Settings settings;
  Workflow flow(device, problem, settings);
  flow.base.scene = problem.scene.scene;
  std::vector<Candidate> candidates = make_candidates(problem, {});
  std::erase_if(candidates, [](const Candidate& c) {
    return c.name != "retune_gravity" && c.name != "constant_force" && c.name != "gravity_tilt" &&
           c.name != "linear_drag";
  });
  ASSERT_EQ(candidates.size(), 4u);
  const FitData data = flow.fitter.prepare(make_windows(problem, false, 0, 3), Model{});
  const Fit base = fit_as_it_stands(flow.fitter, data);
  const Round round = run_round(flow, candidates, data, base, "1", 0);
  ASSERT_GE(round.decision.chosen, 0);
  const auto name = [&](std::size_t i) { return round.decision.ranking[i].fit->model.parts[0]->name; };
  const Fit& named = *round.decision.ranking[std::size_t(round.decision.chosen)].fit;
  EXPECT_EQ(name(std::size_t(round.decision.chosen)), "retune_gravity");
  EXPECT_NEAR(named.model.x[0], GRAVITY, 3 * std::sqrt(named.covariance(0, 0)));
  std::vector<std::string> told;
  for (const std::size_t i : round.decision.inseparable) told.push_back(name(i));
  EXPECT_NE(std::find(told.begin(), told.end(), "constant_force"), told.end());
}

}  // namespace
}  // namespace pvg::diagnose
