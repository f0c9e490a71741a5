// Scenes whose simulation takes seconds: candidates are simulated once, beside the scene as it stands, and a second
// effect is ranked by that. A pendulum is taken for such a scene here.
#include <gtest/gtest.h>

#include <cmath>

#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/search/round.hpp"
#include "tests/identify/damped_pendulum.hpp"

namespace pvg::diagnose {
namespace {

struct LargeScenes : testing::Test {
  LargeScenes() { set_criterion("large_world", 1); }
  ~LargeScenes() override { reset_criteria(); }
};

// Alone the spring leaves the decay, and the friction leaves the frequency. Of the first half second: later the swing
// without them is out of phase, and what they change of it tells little of what they change of the true one.
TEST_F(LargeScenes, ASecondEffectIsFoundByWhatTheFirstRoundSimulatedWhereEachAloneFails) {
  DampedPendulum pendulum;
  Workflow& flow = pendulum.flow;
  const FitData data = first_part(pendulum.problem, pendulum.data, 0.25);
  const auto fitted = [&](const char* name) {
    return flow.fitter.fit(data, {model_of({&pendulum.candidate(name)})}, 10).front();
  };
  const Fit base = fit_as_it_stands(flow.fitter, data);
  const Round first = run_round(flow, pendulum.candidates, data, base, "1", 0);
  ASSERT_FALSE(first.changes.trials.empty());
  ASSERT_TRUE(are_in(first.changes, data));
  const Fit spring = fitted("joint_spring");
  EXPECT_GT(rms(spring.residual), criteria().unexplained);
  EXPECT_GT(rms(fitted("joint_viscous_friction").residual), criteria().unexplained);
  const std::size_t n_before = flow.predictor.n_simulations();
  const std::vector<Screened> beside =
      screen_by_changes(data, spring, others_than(pendulum.candidates, spring.model), first.changes);
  EXPECT_EQ(flow.predictor.n_simulations(), n_before);
  EXPECT_FALSE(beside.empty());
  const Round second = run_round(flow, pendulum.candidates, data, spring, "2", 0, {}, first.changes);
  ASSERT_GE(second.decision.chosen, 0);
  const Fit& both = *second.decision.ranking[std::size_t(second.decision.chosen)].fit;
  // at the center of mass of a bar that turns about one axis drag is the same law
  const std::string& damper = both.model.parts.back()->name;
  EXPECT_TRUE(damper == "joint_viscous_friction" || damper == "linear_drag") << damper;
  EXPECT_LT(rms(both.residual), 1.1);
  EXPECT_NEAR(both.model.x[0], DampedPendulum::SPRING, 3 * std::sqrt(both.covariance(0, 0)));
}

}  // namespace
}  // namespace pvg::diagnose
