// Fits of a model and of the start of its window together, where both bend the same curve
#include "host/identify/fit/fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/fit/prepared.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// A block of 0.4 kg slides at 1 m/s on a floor of friction 0.3 and is braked by c v^2 besides, c = 0.8 N s^2/m^2:
//   y(t) = ln(cos(p - t sqrt(a b)) / cos p) / b,   a = 0.3 g, b = c / m, tan p = sqrt(b / a) s/m,   until it stops
double braked(double t) {
  const double a = 0.3 * 9.81, b = 0.8 / 0.4, p = std::atan(std::sqrt(b / a)), w = std::sqrt(a * b);
  return std::log(std::cos(p - w * std::min(t, p / w)) / std::cos(p)) / b;
}

Problem sliding(const TestFolder& folder) {
  folder.write("scene.yaml", R"(schema: 1
name: slide
time_step: 5 ms
contact: {activation_distance: 0.1 mm, stiffness: 10 MPa, friction_velocity: 1e-3}
bodies:
  - {name: floor, kind: half_space, normal: [0, 0, 1]}
  - {name: block, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.04]}}, mass: 0.4, pose: {position: [0, 0, 0.02009]}}
pair_friction:
  - {first: floor, second: block, coefficient: 0.3}
)");
  std::string run = "t,x,y,z\n";
  for (int i = 0; i < 35; ++i) run += std::to_string(0.01 * i) + ",0," + std::to_string(braked(0.01 * i)) + ",0.02\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {columns: [x, y, z], kind: position, body: block, unit: m, noise: 0.0005}
)");
  return make_problem(folder.path / "recording.yaml");
}

// The run, prepared about the start that fits best without any effect.
FitData prepared_near(Fitter& fitter, const Problem& problem) {
  FitData data = fitter.prepare(make_windows(problem, false, 0, 1), Model{});
  const Fit starts = fitter.fit(data, {Model{}}, 0).front();
  return fitter.prepared_nearer(std::move(data), starts);
}

TEST(Fit, EverySampleOfASlideIsOfTheSlideTheFirstAmongThem) {
  const TestFolder folder;
  const Problem problem = sliding(folder);
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const FitData data = prepared_near(fitter, problem);
  ASSERT_EQ(data.windows.size(), 1u);
  const auto found = fitter.evaluate(data, {Model{}}, {}, true);
  const std::vector<Phase>& phase = found.at(0).at(0).phase;
  ASSERT_EQ(phase.size(), data.windows[0].data.size());
  for (std::size_t i = 0; i < phase.size(); ++i)
    if (problem.runs[0].t[data.windows[0].data[i].sample] < 0.2) {
      EXPECT_EQ(phase[i], Phase::slide) << i;
    }
}

TEST(Fit, ResidualsOfANoisyRunAreInUnitsOfItsOwnNoise) {
  const TestFolder folder;
  Problem problem = sliding(folder);
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const auto residual = [&](double noise_scale) {
    problem.runs[0].noise_scale = {noise_scale};
    const FitData data = fitter.prepare(make_windows(problem, false, 0, 1), Model{});
    return fitter.evaluate(data, {Model{}}, {})[0][0].residual;
  };
  const Eigen::VectorXd usual = residual(1), noisy = residual(4);
  ASSERT_GT(usual.norm(), 1);
  EXPECT_LT((4 * noisy - usual).norm(), 1e-4 * usual.norm());  // the correction for the time step follows within 1e-5
}

// The sliding block, and the drag that brakes it among the candidates.
struct SlidingBlock {
  const TestFolder folder;
  const Problem problem = sliding(folder);
  Device device;
  Predictor predictor{device, problem};
  const Variant base{problem.scene.scene, {}};
  Fitter fitter{predictor, base};
  const std::vector<Candidate> candidates = make_candidates(problem, {"floor/block"});

  const Candidate* drag() const {
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [](const Candidate& c) { return c.name == "quadratic_drag"; });
    return found == candidates.end() ? nullptr : &*found;
  }
};

// A new preparation changes the residuals, so the scene as it stands must be fitted to it, too, before errors are
// compared.
TEST(Prepared, TheBaseIsFittedToThePresentPreparation) {
  SlidingBlock block;
  Fitter& fitter = block.fitter;
  const Candidate* drag = block.drag();
  ASSERT_NE(drag, nullptr);
  Prepared prepared(fitter.prepare(make_windows(block.problem, false, 0, 1), Model{}));
  const Fit before = prepared.base(fitter);
  const Model model{{drag}, Eigen::VectorXd::Constant(1, 0.6), Eigen::VectorXd::Constant(1, 0.1)};
  const Fit found = prepared_again(fitter, prepared, fitter.fit(prepared.data(), {model}, 5).front());
  EXPECT_NEAR(found.model.x[0], 0.8, 0.05);
  const Fit again = fit_as_it_stands(fitter, prepared.data());
  ASSERT_EQ(prepared.base(fitter).residual.size(), 1u);
  EXPECT_EQ(prepared.base(fitter).residual[0], again.residual[0]);
  EXPECT_NE(before.residual[0], again.residual[0]);
}

// A preparation may move starts less far than the fit had moved them.
TEST(Prepared, AFitGoesOnFromTheStartsThatItHas) {
  SlidingBlock block;
  Fitter& fitter = block.fitter;
  const Candidate* drag = block.drag();
  ASSERT_NE(drag, nullptr);
  FitData data = fitter.prepare(make_windows(block.problem, false, 0, 1), Model{});
  ASSERT_EQ(data.windows.size(), 1u);
  for (const Unknown& unknown : data.windows[0].unknowns) move(data.windows[0].initial, unknown, unknown.sigma);
  const Model model{{drag}, Eigen::VectorXd::Constant(1, 0.8), Eigen::VectorXd::Constant(1, 0.1)};
  Prepared prepared(fitter.prepare(data.windows, model));
  const Fit fit = fitter.fit(prepared.data(), {model}, 10).front();
  ASSERT_LT(fit.delta[0].minCoeff(), -0.5);  // of what it was moved by, in which a preparation follows by 0.2
  for (const char* steps : {"n_start_steps=1", "n_more_steps=1", "n_last_steps=1"}) set_criterion(steps);
  const Fit again = prepared_again(fitter, prepared, fit);
  reset_criteria();
  EXPECT_LT(rms(again.residual), 1.1 * rms(fit.residual));
}

TEST(Fit, OfTheFirstPartOfAWindowIsThatOfItsFirstSamples) {
  const TestFolder folder;
  const Problem problem = sliding(folder);
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const FitData whole = fitter.prepare(make_windows(problem, false, 0, 1), Model{});
  ASSERT_EQ(whole.windows.size(), 1u);
  const FitData part = first_part(problem, whole, 0.5);
  const Window& window = part.windows.at(0);
  EXPECT_DOUBLE_EQ(window.end, 0.17);      // of 0.34 s
  ASSERT_EQ(window.data.size(), 3 * 18u);  // samples 0 to 17
  const auto of_whole = fitter.evaluate(whole, {Model{}}, {}), of_part = fitter.evaluate(part, {Model{}}, {});
  for (std::size_t i = 0, k = 0; i < whole.windows[0].data.size(); ++i) {
    if (whole.windows[0].data[i].sample > 17) continue;
    const Eigen::Index all = Eigen::Index(i), here = Eigen::Index(k++);
    EXPECT_EQ(window.data[std::size_t(here)].sample, whole.windows[0].data[i].sample);
    EXPECT_NEAR(of_part[0][0].residual[here], of_whole[0][0].residual[all], 1e-9) << i;
    EXPECT_EQ(part.of_start[0].row(here), whole.of_start[0].row(all)) << i;
  }
}

TEST(Fit, FindsTheDragOfASlidingBlockThoughItsStartMustMoveWithIt) {
  const TestFolder folder;
  const Problem problem = sliding(folder);
  Device device;
  Predictor predictor(device, problem);
  Variant base{problem.scene.scene, {}};
  base.scene.solver.velocity_tolerance = 1e-6;
  base.scene.solver.cg_tolerance = 1e-8;
  Fitter fitter(predictor, base);
  const FitData data = prepared_near(fitter, problem);
  ASSERT_EQ(data.windows.size(), 1u);
  const std::vector<Candidate> candidates = make_candidates(problem, {"floor/block"});
  const auto drag = std::find_if(candidates.begin(), candidates.end(),
                                 [](const Candidate& candidate) { return candidate.name == "quadratic_drag"; });
  ASSERT_NE(drag, candidates.end());
  const Model far{{&*drag}, Eigen::VectorXd::Constant(1, 0.2), Eigen::VectorXd::Constant(1, 0.02)};
  const Fit fit = fitter.fit(data, {far}, 4).front();
  ASSERT_TRUE(fit.succeeded);
  EXPECT_NEAR(fit.model.x[0], 0.8, 0.04);  // steps of 5 ms add 0.025; the start as it was known leaves 0.13
  EXPECT_LT(rms(fit.residual), 0.3);       // the data have no noise
}

}  // namespace
}  // namespace pvg::diagnose
