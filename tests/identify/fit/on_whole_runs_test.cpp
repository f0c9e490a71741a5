// What was found in short windows, measured on whole runs
#include "host/identify/fit/on_whole_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/swinging_plate.hpp"

namespace pvg::diagnose {
namespace {

TEST(OnWholeRuns, TheStiffnessOfASpringIsKnownFarBetterThanByWindows) {
  SwingingPlate plate;
  const Fit found = plate.spring_in_windows();
  const auto whole = on_whole_runs(plate.flow.fitter, plate.problem, 8, found);
  ASSERT_TRUE(whole.has_value());
  ASSERT_EQ(whole->data.windows.size(), 1u);
  const double by_windows = std::sqrt(found.covariance(0, 0)), by_run = std::sqrt(whole->fit.covariance(0, 0));
  EXPECT_LT(by_run, by_windows / 2);  // the phase of 2 s tells it, not that of 0.25 s
  EXPECT_LT(std::abs(whole->fit.model.x[0] - SwingingPlate::SPRING), 3 * by_run);
  EXPECT_NEAR(rms(whole->fit.residual), 1, 0.15);
}

TEST(OnWholeRuns, AModelThatLosesThePhaseStaysInItsWindows) {
  SwingingPlate plate;
  Fit found = plate.spring_in_windows();
  found.model.x[0] = 2 * SwingingPlate::SPRING;
  EXPECT_FALSE(on_whole_runs(plate.flow.fitter, plate.problem, 8, found).has_value());
}

}  // namespace
}  // namespace pvg::diagnose
