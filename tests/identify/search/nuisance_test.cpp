// Numbers that a recording states with a standard deviation: free in every model
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/identify/fit/agreement.hpp"
#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/fit/swap.hpp"
#include "host/identify/search/round.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double INERTIA = 0.1 * 0.1 / 6 + 0.15 * 0.15;  // of an arm of 1 kg about its joint [kg m^2]

// A run of an arm that a known torque turns about the vertical, I q'' = tau - c q', by Runge and Kutta's fourth order,
// seen with a noise of 0.5 mrad.
std::string run_of(double mass, double c, double frequency, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0, 5e-4);
  const auto torque = [&](double t) { return 0.1 * std::sin(2 * M_PI * frequency * t); };
  const auto acceleration = [&](double t, double w) { return (torque(t) - c * w) / (mass * INERTIA); };
  std::string table = "t,tau,q\n";
  double q = 0, w = 0;
  constexpr double H = 1e-3;
  for (int i = 0; i <= 800; ++i) {
    const double t = H * i;
    if (i % 10 == 0)
      table += std::to_string(t) + "," + std::to_string(torque(t)) + "," + std::to_string(q + noise(engine)) + "\n";
    const double a1 = acceleration(t, w), a2 = acceleration(t + H / 2, w + H / 2 * a1),
                 a3 = acceleration(t + H / 2, w + H / 2 * a2), a4 = acceleration(t + H, w + H * a3);
    q += H * w + H * H / 6 * (a1 + a2 + a3);
    w += H / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return table;
}

// The recording states 1 +- 0.02 kg.
Problem turned_arm(const TestFolder& folder, double mass, double c) {
  folder.write("scene.yaml", R"(schema: 1
name: turned
time_step: 5 ms
gravity: [0, 0, 0]
solver: {integrator: bdf2}
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, pose: {position: [0.15, 0, 0]}, collides: false}
joints:
  - {name: shoulder, type: revolute, parent: base, child: arm, axis: [0, 0, 1]}
)");
  folder.write("a.csv", run_of(mass, c, 0.6, 1));
  folder.write("b.csv", run_of(mass, c, 1.6, 2));
  folder.write("c.csv", run_of(mass, c, 1.1, 3));
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
  - {file: b.csv, role: fit}
  - {file: c.csv, role: held_out}
inputs:
  - {column: tau, target: joint/shoulder/torque, unit: N m}
channels:
  - {column: q, kind: position, joint: shoulder, unit: rad, noise: 0.0005}
priors:
  body/arm/mass: {sigma: 0.02 kg}
)");
  return make_problem(folder.path / "recording.yaml");
}

TEST(Nuisance, AMassThatIsOffWithinItsPriorIsNoMisfit) {
  const TestFolder folder;
  const Problem problem = turned_arm(folder, 1.02, 0);
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const FitData data = fitter.prepare(make_windows(problem, false, 0, 2), Model{});
  const Fit held = fit_as_it_stands(fitter, data);
  EXPECT_FALSE(agreement_of(problem, data.windows, held.residual).is_agreement);
  const std::vector<Candidate> nuisances = nuisances_of(problem);
  ASSERT_EQ(nuisances.size(), 1u);
  fitter.stand_at(model_of({&nuisances[0]}));
  const Fit free = fit_as_it_stands(fitter, data);
  EXPECT_TRUE(agreement_of(problem, data.windows, free.residual).is_agreement);
  const double deviation = std::sqrt(free.covariance(0, 0));
  EXPECT_LT(deviation, 0.005);
  EXPECT_NEAR(free.model.x[0], 1.02, 3 * deviation);
}

TEST(Nuisance, FrictionIsNamedBesideAMassThatIsOffWithinItsPrior) {
  const TestFolder folder;
  Problem problem = turned_arm(folder, 1.02, 0.01);
  Device device;
  const Settings settings;
  Workflow flow(device, problem, settings);
  flow.base.scene = problem.scene.scene;
  std::vector<Candidate> candidates = make_candidates(problem, {});
  std::erase_if(candidates, [](const Candidate& c) {
    return c.name != "joint_viscous_friction" && c.name != "joint_coulomb_friction" && c.name != "retune_mass";
  });
  ASSERT_EQ(candidates.size(), 3u);
  FitData data = flow.fitter.prepare(make_windows(problem, false, 0, 2), Model{});
  flow.fitter.stand_at(model_of({&flow.nuisances.at(0)}));
  const Fit base = fit_as_it_stands(flow.fitter, data);
  const Round round = run_round(flow, candidates, data, base, "1", 0);
  ASSERT_GE(round.decision.chosen, 0);
  const Fit& named = *round.decision.ranking[std::size_t(round.decision.chosen)].fit;
  ASSERT_EQ(named.model.effects().size(), 1u);
  EXPECT_EQ(named.model.effects()[0]->label(), "joint_viscous_friction at shoulder");
  EXPECT_LT(rms(named.residual), 1.1);
  EXPECT_NEAR(named.model.x[0], 1.02, 3 * std::sqrt(named.covariance(0, 0)));
  EXPECT_NEAR(named.model.x[1], 0.01, 5e-4);
}

TEST(Nuisance, ThatWentAsFarAsItMayIsTriedAsAWrongNumber) {
  const TestFolder folder;
  const Problem problem = turned_arm(folder, 1, 0);
  const std::vector<Candidate> candidates = make_candidates(problem, {}), nuisances = nuisances_of(problem);
  ASSERT_EQ(nuisances.size(), 1u);
  Model model = model_of({&nuisances[0]});
  EXPECT_TRUE(with_wrong_numbers(model, candidates).empty());
  model.x[0] = 1 + 4 * 0.02;
  const std::vector<Model> farther = with_wrong_numbers(model, candidates);
  ASSERT_EQ(farther.size(), 1u);
  EXPECT_EQ(farther[0].n_nuisances(), 0);
  ASSERT_EQ(farther[0].effects().size(), 1u);
  EXPECT_EQ(farther[0].effects()[0]->label(), "retune_mass at arm");
  EXPECT_EQ(farther[0].x[0], model.x[0]);
  EXPECT_GT(farther[0].parameters()[0]->high, 2);
}

}  // namespace
}  // namespace pvg::diagnose
