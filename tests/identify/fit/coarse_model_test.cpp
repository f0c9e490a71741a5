// Changes in coarse steps
#include "host/identify/fit/coarse_model.hpp"

#include <gtest/gtest.h>

#include "tests/identify/fit/spinning_plate.hpp"

namespace pvg::diagnose {
namespace {

struct Spin {
  TestFolder folder;
  Problem problem = spinning_plate(folder);
  Device device;
  Predictor predictor{device, problem};
  Variant base{problem.scene.scene, {}};
  Fitter fitter{predictor, base};
  Spin() { base.scene.solver.integrator = SolverSettings::Integrator::bdf2; }
  FitData whole_run() { return fitter.prepare(make_windows(problem, false, 0, 1), {}, false); }
};

// Steps of the scene's 5 ms instead of 1.25 ms leave some 50 times the noise of 1 mrad beside a motion of 5000.
TEST(CoarseModel, LeavesWhatTheFineOneDoesAtItsBaseAndAsMuchMoreByAChange) {
  Spin spin;
  spin.base.scene.solver.time_step = 0.00125;
  const FitData data = spin.whole_run();
  const std::optional<CoarseModel> coarse =
      coarse_model(spin.fitter, spin.predictor, spin.problem, spin.base, data, {});
  ASSERT_TRUE(coarse);
  EXPECT_DOUBLE_EQ(coarse->variant->scene.solver.time_step, 0.005);
  const std::vector<Candidate> candidates = make_candidates(spin.problem, {});
  const auto mass = std::find_if(candidates.begin(), candidates.end(),
                                 [](const Candidate& c) { return c.label() == "retune_mass at plate"; });
  ASSERT_NE(mass, candidates.end());
  Model heavier = model_of({&*mass});
  heavier.x[0] = 1.01;
  const auto residual_of = [&](Fitter& fitter, const FitData& in, const Model& model) {
    return fitter.evaluate(in, {model}, {}).front().front().residual;
  };
  const Eigen::VectorXd fine = residual_of(spin.fitter, data, {}),
                        same = residual_of(*coarse->fitter, coarse->data, {});
  EXPECT_LT((fine - same).cwiseAbs().maxCoeff(), 1e-6);
  const Eigen::VectorXd change = residual_of(spin.fitter, data, heavier) - fine,
                        of_coarse = residual_of(*coarse->fitter, coarse->data, heavier) - same;
  EXPECT_GT(rms({change}), 10);
  EXPECT_LT(rms({change - of_coarse}), 0.05 * rms({change}));
}

TEST(CoarseModel, IsNoneWhereItsStepsAreHardlyLonger) {
  Spin spin;
  const FitData data = spin.whole_run();
  EXPECT_FALSE(coarse_model(spin.fitter, spin.predictor, spin.problem, spin.base, data, {}));
  spin.base.scene.solver.time_step = 0.0025;
  EXPECT_FALSE(coarse_model(spin.fitter, spin.predictor, spin.problem, spin.base, data, {}));
}

// 100 ms instead of 5 ms: the plate turns by 3 rad in a step.
TEST(CoarseModel, IsNoneWhereLongStepsDoNotFollowTheMotion) {
  Spin spin;
  const FitData data = spin.whole_run();
  spin.problem.scene.scene.solver.time_step = 0.1;
  const std::optional<CoarseModel> coarse =
      coarse_model(spin.fitter, spin.predictor, spin.problem, spin.base, data, {});
  EXPECT_TRUE(!coarse || coarse->variant->scene.solver.time_step < 0.05);
}

}  // namespace
}  // namespace pvg::diagnose
