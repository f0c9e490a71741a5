// Friction that falls with speed, on a plate that is mostly much faster than the speed at which it falls
#include "host/identify/search/screen_trials.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "host/identify/fit/choose_windows.hpp"
#include "tests/identify/spindle.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double EFFORT = 2e-4, EXTRA = 3e-4, SPEED = 1;  // [N m], [N m], [rad/s]

// I q'' = tau - (EFFORT + EXTRA exp(-(q' / SPEED)^2)) sign(q') of I = 2 / 300 kg m^2, in steps of 0.1 ms from rest,
// which a torque turns to and fro; the noise is 1.5 mrad. Dry friction leaves ten times that.
std::string run_of(double amplitude, double frequency, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0, 1.5e-3);
  constexpr double INERTIA = 2.0 / 300, H = 1e-4;
  std::ostringstream table;
  table.precision(9);
  table << "t,tau,q\n";
  double q = 0, w = 0;
  for (int i = 0; i <= 24000; ++i) {
    const double t = H * i, tau = amplitude * std::sin(2 * M_PI * frequency * t);
    if (i % 100 == 0) table << t << "," << tau << "," << q + noise(engine) << "\n";
    const double friction = (EFFORT + EXTRA * std::exp(-w * w / (SPEED * SPEED))) * std::tanh(w / 1e-4);
    w += H * (tau - friction) / INERTIA;
    q += H * w;
  }
  return table.str();
}

Problem falling_friction(const TestFolder& folder) {
  folder.write("scene.yaml", plate_on_a_spindle("2.5 ms"));
  folder.write("a.csv", run_of(0.1, 0.8, 1));
  folder.write("b.csv", run_of(-0.05, 1.3, 2));
  folder.write("c.csv", run_of(0.02, 0.5, 3));
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
  - {file: b.csv, role: fit}
  - {file: c.csv, role: fit}
inputs:
  - {column: tau, target: joint/spindle/torque, unit: N m}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, noise: 0.0015}
)");
  return make_problem(folder.path / "recording.yaml");
}

struct FallingFriction : testing::Test {
  TestFolder folder;
  Problem problem = falling_friction(folder);
  Device device;
  Predictor predictor{device, problem};
  Variant base{problem.scene.scene, {}};
  Fitter fitter{predictor, base};
  std::vector<Candidate> candidates = make_candidates(problem, {});
  const Candidate& law = *std::find_if(candidates.begin(), candidates.end(),
                                       [](const Candidate& c) { return c.name == "joint_stribeck_friction"; });
  FitData data = fitter.prepare(make_windows(problem, false, 0, 3), Model{});
  Fit scene = fit_as_it_stands(fitter, data);
};

// At each speed with the strengths that fit there, whatever they were for the usual 0.1 rad/s.
TEST_F(FallingFriction, IsTriedWithTheStrengthsOfEachSpeed) {
  Screened screened{&law, model_of({&law})};
  screened.model.x.head(2) << 1.2 * EFFORT, 5 * EXTRA;
  const std::vector<Model> places = places_at_shapes(fitter, data, scene, screened);
  const auto at_speed = std::find_if(places.begin(), places.end(),
                                     [](const Model& model) { return std::abs(model.x[2] - SPEED) < 1e-9; });
  ASSERT_NE(at_speed, places.end());
  EXPECT_NEAR(at_speed->x[0], EFFORT, 0.1 * EFFORT);
  EXPECT_NEAR(at_speed->x[1], EXTRA, 0.3 * EXTRA);
}

TEST_F(FallingFriction, EndsAtItsSpeed) {
  const std::vector<Screened> found = screen(fitter, data, scene, {&law}).best;
  ASSERT_EQ(found.size(), 1u);
  const Fit fit = fitter.fit(data, {found[0].model}, 10).front();
  EXPECT_NEAR(fit.model.x[2], SPEED, 3 * std::sqrt(fit.covariance(2, 2)));
  EXPECT_GT(fit.model.x[2], SPEED / 3);  // below it is dry friction
  EXPECT_NEAR(rms(fit.residual), 1, 0.1);
}

// A law of one strength has nothing to be told apart from its shape where it is off.
TEST_F(FallingFriction, OfOneStrengthHasNoSuchPlaces) {
  const auto dry = std::find_if(candidates.begin(), candidates.end(),
                                [](const Candidate& c) { return c.name == "joint_coulomb_friction"; });
  EXPECT_TRUE(places_at_shapes(fitter, data, scene, {&*dry, model_of({&*dry})}).empty());
}

}  // namespace
}  // namespace pvg::diagnose
