// What lies factors away from where a candidate is tried first: a number of the scene, the shape of a law. It is
// screened on a grid and fitted in its logarithm.
#include "host/identify/search/screen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/search/decide.hpp"
#include "host/identify/search/screen_trials.hpp"
#include "tests/identify/driven_arm.hpp"

namespace pvg::diagnose {
namespace {

// An arm of the inertia m (s^2 / 6 + a^2) = 0.0241667 kg m^2 on a drive of k = 20 N m/rad and d = 0.6 N m s/rad that is
// told to go to 0.3 rad at once:  q = 0.3 (1 - exp(-z t) (cos(w t) + z / w sin(w t))),  z = d / 2 I, w^2 = k / I - z^2
double driven(double t) {
  const double inertia = 0.1 * 0.1 / 6 + 0.15 * 0.15, z = 0.6 / (2 * inertia), w = std::sqrt(20 / inertia - z * z);
  return 0.3 * (1 - std::exp(-z * t) * (std::cos(w * t) + z / w * std::sin(w * t)));
}

constexpr const char* BDF2 = "solver: {integrator: bdf2}\n";

// The scene says 1280 N m/rad, 64 times too much.
Problem too_stiff(const TestFolder& folder) {
  folder.write("scene.yaml", driven_arm("2 ms", "{stiffness: 1280, damping: 0.6, target: 0.3}", BDF2));
  std::string run = "t,q\n";
  for (int i = 0; i < 40; ++i) run += std::to_string(0.01 * i) + "," + std::to_string(driven(0.01 * i)) + "\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: q, kind: position, joint: shoulder, unit: rad, noise: 0.001}
initial: {joint/shoulder/position: 0, joint/shoulder/velocity: 0}
)");
  return make_problem(folder.path / "recording.yaml");
}

// A problem of whole runs, and its candidates, of which one is screened alone.
struct ScreenedAlone {
  Device device;
  Predictor predictor;
  const Variant base;
  Fitter fitter;
  const FitData data;
  const std::vector<Candidate> candidates;

  explicit ScreenedAlone(const Problem& problem)
      : predictor(device, problem),
        base{problem.scene.scene, {}},
        fitter(predictor, base),
        data(fitter.prepare(make_windows(problem, false, 0, 1), Model{}, false)),
        candidates(make_candidates(problem, {})) {}

  std::vector<Screened> screened(const std::string& name) {
    const auto found =
        std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& one) { return one.name == name; });
    EXPECT_NE(found, candidates.end()) << name;
    if (found == candidates.end()) return {};
    return screen(fitter, data, fit_as_it_stands(fitter, data), {&*found}).best;
  }
};

TEST(Screen, AStiffness64TimesTooLargeIsReachedAndFitted) {
  const TestFolder folder;
  const Problem problem = too_stiff(folder);
  ScreenedAlone alone(problem);
  const std::vector<Screened> found = alone.screened("retune_drive_stiffness");
  ASSERT_EQ(found.size(), 1u);
  const Fit fit = alone.fitter.fit(alone.data, {found[0].model}, 10).front();
  EXPECT_NEAR(fit.model.x[0], 20, 0.2);
  EXPECT_FALSE(is_at_bound(fit));
}

// An arm that follows v = 0.3 rad/s behind its command by c v / k: I q'' = k (v t - q) + d (v - q') - c q' is solved by
// q = v t - c v / k. The friction c = 10 N m s/rad is thousands of times what is tried first, which goes by the arm's
// inertia and is next to nothing beside the drive.
TEST(Screen, FrictionThatADriveWorksAgainstIsTriedAsFarAsItShows) {
  const TestFolder folder;
  folder.write("scene.yaml", driven_arm("2 ms", "{stiffness: 400, damping: 40, target: 0}", BDF2));
  const double c = 10, k = 400, v = 0.3;
  std::ostringstream run;
  run << std::setprecision(12) << "t,command,q\n";
  for (int i = 0; i < 40; ++i) run << 0.01 * i << "," << v * 0.01 * i << "," << v * 0.01 * i - c * v / k << "\n";
  write_driven_recording(folder, run.str(),
                         "initial: {joint/shoulder/position: -0.0075, joint/shoulder/velocity: 0.3}\n");
  const Problem problem = make_problem(folder.path / "recording.yaml");
  ScreenedAlone alone(problem);
  const std::vector<Screened> found = alone.screened("joint_viscous_friction");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].model.x[0], c, 0.1 * c);
}

TEST(Screen, ALawIsTriedAtShapesOfTwoDecadesWithEqualStrengths) {
  const TestFolder folder;
  const Problem problem = too_stiff(folder);
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto stribeck = std::find_if(candidates.begin(), candidates.end(),
                                     [](const Candidate& c) { return c.name == "joint_stribeck_friction"; });
  ASSERT_NE(stribeck, candidates.end());
  ASSERT_EQ(stribeck->parameters.size(), 3u);  // two strengths and the velocity, 0.1 rad/s at first
  EXPECT_FALSE(stribeck->parameters[0].is_logarithmic);
  EXPECT_TRUE(stribeck->parameters[2].is_logarithmic);
  Screened screened{&*stribeck, model_of({&*stribeck})};
  screened.model.x.head(2) << 3e-4, 2e-3;
  const std::vector<Model> places = places_of(screened, 0);
  for (const double velocity : {0.01, 0.03, 0.1, 0.3, 1.0})
    EXPECT_TRUE(std::any_of(places.begin(), places.end(), [&](const Model& model) {
      return model.x.isApprox(Eigen::Vector3d(3e-4, 3e-4, velocity), 1e-12);
    })) << velocity;
}

// x = (-10, 11) is the least of 1/2 (x - (-10, 11)) A (x - (-10, 11)). With x_0 held at -1 the best x_1 is, by hand,
// 11 - 0.99 (10 - 1) = 2.09; the 11 that is best beside -10 is worse than nothing.
TEST(Screen, WhatIsLimitedIsNoReasonToLeaveTheOthersWhereTheyAreBestWithoutLimits) {
  const Eigen::Matrix2d a{{1, 0.99}, {0.99, 1}};
  const Eigen::Vector2d free(-10, 11), g = -a * free;
  const auto cost = [&](const Eigen::Vector2d& x) { return g.dot(x) + 0.5 * x.dot(a * x); };
  const Eigen::Vector2d wide = Eigen::Vector2d::Constant(100);
  EXPECT_TRUE(least_within(a, g, -wide, wide).isApprox(free, 1e-9));
  const Eigen::Vector2d found = least_within(a, g, Eigen::Vector2d(-1, -100), Eigen::Vector2d(1, 100));
  EXPECT_NEAR(found[0], -1, 1e-12);
  EXPECT_NEAR(found[1], 2.09, 1e-9);
  EXPECT_LT(cost(found), 0);
  EXPECT_GT(cost({-1, 11}), 0);
}

TEST(Screen, AFitAtABoundPassesNothing) {
  Candidate stiffness;
  stiffness.parameters = {{"value", "N m/rad", 0.02, 2e4, 20}};
  stiffness.parameters[0].is_logarithmic = true;
  Fit fit;
  fit.model = {{&stiffness}, Eigen::VectorXd::Constant(1, 0.02), Eigen::VectorXd::Ones(1)};
  EXPECT_TRUE(is_at_bound(fit));
  fit.model.x[0] = 0.03;
  EXPECT_FALSE(is_at_bound(fit));
}

// One candidate at a time finds what all at once do, and the time ends it after whole ones.
TEST(Screen, InPartsFindsTheSameAndStopsAtItsShareOfTheTime) {
  const TestFolder folder;
  const Problem problem = too_stiff(folder);
  ScreenedAlone of(problem);
  std::vector<const Candidate*> some;
  for (const Candidate& candidate : of.candidates)
    if (candidate.target == "shoulder" && some.size() < 5) some.push_back(&candidate);
  ASSERT_EQ(some.size(), 5u);
  const Fit scene = fit_as_it_stands(of.fitter, of.data);
  const auto screened_by = [&](const Effort& effort) {
    return screen(of.fitter, of.data, scene, some, nullptr, effort);
  };
  const ScreeningResult at_once = screened_by({}), in_parts = screened_by({1, 0.9});
  EXPECT_EQ(in_parts.n_screened, some.size());
  ASSERT_EQ(in_parts.best.size(), at_once.best.size());
  for (std::size_t i = 0; i < at_once.best.size(); ++i) {
    EXPECT_EQ(in_parts.best[i].candidate, at_once.best[i].candidate);
    EXPECT_EQ(in_parts.best[i].gain, at_once.best[i].gain);
  }
  const ScreeningResult none = screened_by({1, -1e-9});  // its time was over before it began
  EXPECT_EQ(none.n_screened, 0u);
  EXPECT_TRUE(none.best.empty());
}

}  // namespace
}  // namespace pvg::diagnose
