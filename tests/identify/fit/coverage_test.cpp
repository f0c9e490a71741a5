// Intervals hold the truth over repeated noise, whether the correction for the time step is right or not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/identify/fit/correlation.hpp"
#include "host/identify/fit/fit.hpp"
#include "host/identify/fit/fit_cost.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double NOISE = 5e-4, VISCOUS = 50, COULOMB = 8;  // [rad, N m s/rad, N m]
constexpr std::size_t N_SAMPLES = 100, N_JOINTS = 2;
constexpr double INTERVAL = 0.02;  // of samples [s]
constexpr unsigned N_SEEDS = 5;

// 2000 numbers that depend on x by a sine, predicted with a correction of 0.2 times the noise that is half along it
// and of which nature knows but a share: r = sin (x - x*) + (1 - share) c + noise. The best x is off by 4.6 times what
// the noise alone gives where nature's share is 0.
struct LinearProblem {
  static constexpr Eigen::Index N = 2000;
  const Eigen::VectorXd slope = Eigen::VectorXd::NullaryExpr(N, [](Eigen::Index i) { return wave(double(i)); });
  const Eigen::VectorXd correction = Eigen::VectorXd::NullaryExpr(
      N, [](Eigen::Index i) { return 0.1 * wave(double(i)) + 0.17 * wave(double(i) + 0.25 * PERIOD); });
  Candidate candidate;
  Window window;

  static constexpr double PERIOD = 100;
  static double wave(double i) { return std::sqrt(2) * std::sin(2 * M_PI * i / PERIOD); }

  LinearProblem() {
    candidate.parameters = {{"x", "1", -100, 100, 0}};
    window.correction = correction;
  }

  // One standard deviation of x, and how far it is off.
  std::pair<double, double> fitted(double share_of_nature, unsigned seed) const {
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise;
    const Eigen::VectorXd at_truth = (1 - share_of_nature) * correction +
                                     Eigen::VectorXd::NullaryExpr(N, [&](Eigen::Index) { return noise(engine); });
    const double off = -slope.dot(at_truth) / slope.squaredNorm();
    Fit fit;
    fit.model = model_of({&candidate});
    fit.residual = {at_truth + slope * off};
    fit.slope = {slope};
    fit.of_start = {Eigen::MatrixXd(N, 0)};
    fit.delta = {Eigen::VectorXd(0)};
    fit.scale = robust_scale(fit.residual);
    return {std::sqrt(covariance_of(fit, {window}, 1)(0, 0)), off};
  }
};

TEST(Interval, HoldsWhereNatureContradictsTheCorrectionForTheTimeStep) {
  const LinearProblem problem;
  for (const double share : {0.0, 0.5, 1.0}) {
    int n_held = 0;
    double widest = 0;
    for (unsigned seed = 1; seed <= 100; ++seed) {
      const auto [deviation, off] = problem.fitted(share, seed);
      n_held += std::abs(off) < 2 * deviation;
      widest = std::max(widest, deviation);
    }
    EXPECT_GE(n_held, 90) << "of 100, nature's share being " << share;
    if (share == 1) {
      EXPECT_LT(widest, 2.5 / std::sqrt(double(LinearProblem::N))) << "nothing contradicts it";
    }
  }
}

// A ball that falls with drag for `seconds`, seen 15 times a second, of which gravity alone is fitted, start and all.
// One standard deviation of gravity by the only run, and gravity.
std::pair<double, double> gravity_of_a_drop(double seconds, unsigned seed, double drag) {
  constexpr double SEEN = 1. / 15, NOISED = 0.05, STEP = 1e-4;  // [s], [m], [s]
  const Eigen::Index n = Eigen::Index(seconds / SEEN);
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise;
  Eigen::VectorXd height(n);
  double z = 0, v = 0, t = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (; t < double(i) * SEEN; t += STEP) v += STEP * (-9.81 - drag * v * std::abs(v)), z += STEP * v;
    height[i] = z / NOISED + noise(engine);
  }
  Candidate gravity;
  gravity.parameters = {{"value", "m/s^2", 0, 100, 9.81}};
  Fit fit;
  fit.model = model_of({&gravity});
  Eigen::MatrixXd all(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double at = double(i) * SEEN;
    all.row(i) << at * at / 2 / NOISED, 1e3, 1e3 * at;  // a start that nothing is known of
  }
  const Eigen::VectorXd best = all.colPivHouseholderQr().solve(height);
  fit.model.x[0] = -best[0];
  fit.residual = {height - all * best};
  fit.slope = {all.col(0)};
  fit.of_start = {all.rightCols(2)};
  fit.delta = {Eigen::VectorXd(best.tail(2))};
  fit.scale = robust_scale(fit.residual);
  Window window;
  for (Eigen::Index i = 0; i < n; ++i) window.data.push_back({0, std::size_t(i), 0});
  const double correlated = correlation_length({window}, fit.residual);
  return {std::sqrt(covariance_of(fit, {window}, correlated)(0, 0)), fit.model.x[0]};
}

// Drag is taken for less gravity, by how much depends on how long the ball falls. Of noise alone nothing widens.
TEST(Interval, OfTwoDropsOfOneBallAgreeThoughDragIsMissing) {
  int n_agree = 0;
  double widest = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto [long_deviation, long_drop] = gravity_of_a_drop(3.0, seed, 0.004);
    const auto [short_deviation, short_drop] = gravity_of_a_drop(2.6, 100 + seed, 0.004);
    n_agree += std::abs(long_drop - short_drop) < 2 * std::hypot(long_deviation, short_deviation);
    widest = std::max(widest, gravity_of_a_drop(3.0, seed, 0).first);
  }
  EXPECT_GE(n_agree, 36) << "of 40";
  EXPECT_LT(widest, 0.06) << "of noise alone, 0.03 m/s^2 being its deviation";
}

// What the drives are told: to another posture and back.
double command(std::size_t joint, double t) {
  const double phase = t / (N_SAMPLES * INTERVAL), way = joint == 0 ? 0.4 : -0.5;
  return way * std::pow(std::sin(M_PI * phase), 2);
}

using Angles = std::vector<std::vector<double>>;  // [joint][sample]

// Two links on drives of 400 N m/rad, recorded from rest at a posture that is known.
Problem recording_of(const TestFolder& folder, const Angles& angles) {
  folder.write("scene.yaml", R"(schema: 1
name: arm
time_step: 10 ms
solver: {integrator: bdf2}
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: upper, kind: rigid, shape: {box: {size: [0.3, 0.06, 0.06]}}, mass: 3, pose: {position: [0.15, 0, 0]}, collides: false}
  - {name: lower, kind: rigid, shape: {box: {size: [0.3, 0.05, 0.05]}}, mass: 2, pose: {position: [0.45, 0, 0]}, collides: false}
joints:
  - {name: shoulder, type: revolute, parent: base, child: upper, axis: [0, 1, 0], drive: {stiffness: 400, damping: 40, target: 0}}
  - {name: elbow, type: revolute, parent: upper, child: lower, axis: [0, 1, 0], parent_frame: {position: [0.15, 0, 0]}, drive: {stiffness: 400, damping: 40, target: 0}}
)");
  std::string run = "t,told_shoulder,told_elbow,shoulder,elbow\n";
  for (std::size_t i = 0; i < N_SAMPLES; ++i) {
    const double t = INTERVAL * double(i);
    char line[200];
    std::snprintf(line, sizeof line, "%.2f,%.9g,%.9g,%.9g,%.9g\n", t, command(0, t), command(1, t), angles[0][i],
                  angles[1][i]);
    run += line;
  }
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
inputs:
  - {column: told_shoulder, target: joint/shoulder/position}
  - {column: told_elbow, target: joint/elbow/position}
channels:
  - {column: shoulder, kind: position, joint: shoulder, unit: rad, noise: 0.0005}
  - {column: elbow, kind: position, joint: elbow, unit: rad, noise: 0.0005}
initial: {joint/shoulder/position: 0, joint/elbow/position: 0}
)");
  return make_problem(folder.path / "recording.yaml");
}

// Viscous friction in the shoulder, Coulomb friction in the elbow.
Model truth_of(const std::vector<Candidate>& all) {
  const auto at = [&](const std::string& name, const std::string& target) {
    return &*std::find_if(all.begin(), all.end(),
                          [&](const Candidate& one) { return one.name == name && one.target == target; });
  };
  Model truth = model_of({at("joint_viscous_friction", "shoulder"), at("joint_coulomb_friction", "elbow")});
  truth.x << VISCOUS, COULOMB;
  return truth;
}

// The angles of an arm with these frictions, in steps of this length.
Angles angles_of(Device& device, const TestFolder& folder, double time_step) {
  Angles angles(N_JOINTS, std::vector<double>(N_SAMPLES));
  for (std::size_t j = 0; j < N_JOINTS; ++j)
    for (std::size_t i = 0; i < N_SAMPLES; ++i) angles[j][i] = command(j, INTERVAL * double(i));
  const Problem problem = recording_of(folder, angles);
  const std::vector<Candidate> all = make_candidates(problem, {});
  Predictor predictor(device, problem);
  Variant nature{problem.scene.scene, {}};
  nature.scene.solver.time_step = time_step;
  Fitter fitter(predictor, nature);
  const FitData data{make_windows(problem, false, 0, 1), {}, {}};
  const Eigen::VectorXd residual = fitter.evaluate(data, {truth_of(all)}, {})[0][0].residual;
  for (std::size_t i = 0; i < data.windows[0].data.size(); ++i) {
    const Datum& d = data.windows[0].data[i];
    angles[std::size_t(d.channel)][d.sample] -= NOISE * residual[Eigen::Index(i)];
  }
  return angles;
}

struct Coverage {
  int n = 0, n_held = 0;      // intervals of two standard deviations; those that hold the truth
  double widest_viscous = 0;  // one standard deviation [N m s/rad]
};

Coverage coverage_where_nature_steps_by(double time_step) {
  const TestFolder folder;
  Device device;
  const Angles clean = angles_of(device, folder, time_step);
  Coverage coverage;
  for (unsigned seed = 1; seed <= N_SEEDS; ++seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise(0, NOISE);
    Angles noisy = clean;
    for (std::vector<double>& joint : noisy)
      for (double& angle : joint) angle += noise(engine);
    const Problem problem = recording_of(folder, noisy);
    const std::vector<Candidate> all = make_candidates(problem, {});
    Predictor predictor(device, problem);
    const Variant base{problem.scene.scene, {}};
    Fitter fitter(predictor, base);
    const Model truth = truth_of(all);
    const FitData data = fitter.prepare(make_windows(problem, false, 0, 1), truth);
    const Fit fit = fitter.fit(data, {truth}, 3).front();
    EXPECT_TRUE(fit.succeeded);
    for (Eigen::Index i = 0; i < truth.x.size(); ++i) {
      const double deviation = std::sqrt(fit.covariance(i, i));
      ++coverage.n;
      coverage.n_held += std::abs(fit.model.x[i] - truth.x[i]) < 2 * deviation;
    }
    coverage.widest_viscous = std::max(coverage.widest_viscous, std::sqrt(fit.covariance(0, 0)));
  }
  return coverage;
}

// Predictions are corrected for the length of their steps, 10 ms. A nature of just these steps, another simulation,
// contradicts that, and the residuals say so. Of ten intervals of 95 % nine or more hold with a probability of 0.91.
TEST(Coverage, OfANatureThatTakesTheStepsOfTheFit) {
  const Coverage found = coverage_where_nature_steps_by(0.01);
  EXPECT_GE(found.n_held, 9) << "of " << found.n;
}

TEST(Coverage, OfANatureOfFineSteps) {
  const Coverage found = coverage_where_nature_steps_by(0.001);
  EXPECT_GE(found.n_held, 9) << "of " << found.n;
  EXPECT_LT(found.widest_viscous, 0.2) << "the correction is right, so it widens little";
}

}  // namespace
}  // namespace pvg::diagnose
