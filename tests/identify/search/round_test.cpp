// Which fits of a round are worth all their steps
#include <gtest/gtest.h>

#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/search/round.hpp"
#include "tests/identify/damped_pendulum.hpp"

namespace pvg::diagnose {
namespace {

// A swing that is a fortieth too slow is a third of a radian behind after two seconds, some 100 times the noise: a
// spring takes most of that away, a constant added to what the sensor reads takes nothing away.
TEST(Round, GivesUpWhereNothingBringsADistantSceneNearer) {
  DampedPendulum pendulum;
  const Fit base = fit_as_it_stands(pendulum.flow.fitter, pendulum.data);
  ASSERT_GT(rms(base.residual), criteria().far_misfit_least);
  const auto is_given_up = [&](const char* name) {
    const Candidate& candidate = pendulum.candidate(name);
    return fit_best(pendulum.flow, pendulum.data, base, {{&candidate, model_of({&candidate})}}).at(0).is_given_up;
  };
  EXPECT_FALSE(is_given_up("joint_spring"));
  EXPECT_TRUE(pendulum.flow.notes.empty());
  EXPECT_TRUE(is_given_up("bias"));
  ASSERT_EQ(pendulum.flow.notes.size(), 1u);
  EXPECT_NE(pendulum.flow.notes[0].find("after their first steps"), std::string::npos);
}

TEST(Round, StepsEndWhereTheSensitivitiesOfItsFinalistsStillFit) {
  EXPECT_DOUBLE_EQ(share_of_steps(100, 0), criteria().time_steps);
  EXPECT_DOUBLE_EQ(share_of_steps(100, 10), criteria().time_steps);  // 20 s as busy as the machine may become
  EXPECT_DOUBLE_EQ(share_of_steps(100, 40), 0.2);
  EXPECT_DOUBLE_EQ(share_of_steps(100, 60), 0);
  EXPECT_DOUBLE_EQ(share_of_steps(-1, 10), 0);
  set_criterion("sensitivities_at_worst", 1);
  EXPECT_DOUBLE_EQ(share_of_steps(100, 40), 0.6);
  reset_criteria();
}

// With no time for a step the finalists are those that are nearest to the data as they begin.
TEST(Round, OutOfTimeInItsStepsKeepsFinalistsAlone) {
  set_criterion("large_world", 1);  // two finalists
  set_criterion("time_steps", 0);
  DampedPendulum pendulum;
  const Fit base = fit_as_it_stands(pendulum.flow.fitter, pendulum.data);
  std::vector<Screened> starts;
  const auto add = [&](const char* name, double by) {
    const Candidate& candidate = pendulum.candidate(name);
    starts.push_back({&candidate, model_of({&candidate})});
    starts.back().model.x[0] += by;
  };
  add("bias", 0);
  add("joint_spring", 0.95 * DampedPendulum::SPRING);
  add("joint_viscous_friction", 0);
  add("joint_spring", DampedPendulum::SPRING);
  const std::vector<Fit> fits = fit_best(pendulum.flow, pendulum.data, base, starts);
  reset_criteria();
  ASSERT_EQ(fits.size(), 2u);
  EXPECT_DOUBLE_EQ(fits[0].model.x[0], DampedPendulum::SPRING);
  EXPECT_DOUBLE_EQ(fits[1].model.x[0], 0.95 * DampedPendulum::SPRING);
  for (const Fit& fit : fits) {
    EXPECT_FALSE(fit.is_stale);
    ASSERT_EQ(fit.covariance.rows(), fit.model.x.size());
    EXPECT_GT(fit.covariance(0, 0), 0);
  }
  ASSERT_EQ(pendulum.flow.left_out.size(), 1u);
  EXPECT_NE(pendulum.flow.left_out[0].find("the last steps of fits"), std::string::npos);
}

}  // namespace
}  // namespace pvg::diagnose
