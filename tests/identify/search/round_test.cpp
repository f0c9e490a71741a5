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

}  // namespace
}  // namespace pvg::diagnose
