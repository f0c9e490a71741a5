// What follows the recorded motion
#include "host/identify/search/follow.hpp"

#include <gtest/gtest.h>

#include "tests/identify/swinging_plate.hpp"

namespace pvg::diagnose {
namespace {

// The plate in its shortest windows, whose residuals these tests say: the scene as it stands leaves 60 times the noise.
struct ShortWindows {
  SwingingPlate plate;
  ChosenWindows windows;
  ShortWindows() {
    windows = {criteria().window_lengths.back(), plate.short_windows({}), {}};
    windows.base.residual = leaving(60);
  }
  std::vector<Eigen::VectorXd> leaving(double error) const {
    std::vector<Eigen::VectorXd> residual;
    for (const Window& window : windows.data.windows)
      residual.push_back(Eigen::VectorXd::Constant(Eigen::Index(window.data.size()), error));
    return residual;
  }
  Fit fit(const std::string& name, double value, double error) {
    Fit found = plate.flow.fitter.begin(windows.data, {plate.model(name, value)}).front();
    found.residual = leaving(error);
    return found;
  }
  bool follows(const Fit& fit) {
    Round round;
    round.fits = {fit};
    return any_follows(plate.flow, windows, round);
  }
};

// Friction does not make a plate swing, whatever starts of short windows make of it.
TEST(Follow, WhatLeavesMuchOfTheShortestWindowsHasToBeNearWholeRuns) {
  ShortWindows short_windows;
  EXPECT_TRUE(short_windows.follows(short_windows.fit("joint_viscous_friction", 0.01, 5)));  // nearly the noise
  EXPECT_TRUE(short_windows.follows(short_windows.fit("joint_spring", SwingingPlate::SPRING, 7)));
  EXPECT_TRUE(short_windows.plate.flow.notes.empty());
  EXPECT_FALSE(short_windows.follows(short_windows.fit("joint_viscous_friction", 0.01, 7)));
  ASSERT_EQ(short_windows.plate.flow.notes.size(), 1u);
  EXPECT_NE(short_windows.plate.flow.notes[0].find("are inputs and rows those of their run?"), std::string::npos);
}

// The swing is 71 times the noise (root mean square).
TEST(Follow, WhatIsAsFarAwayAsTheMotionItselfDoesNot) {
  ShortWindows short_windows;
  EXPECT_FALSE(short_windows.follows(short_windows.fit("joint_spring", SwingingPlate::SPRING, 60)));
}

TEST(Follow, WhatExplainsWindowsAloneGivesWayToWhatFollowsTheRuns) {
  ShortWindows short_windows;
  FitData& data = short_windows.windows.data;
  std::vector<Fit> fits =
      short_windows.plate.flow.fitter.begin(data, {short_windows.plate.model("joint_viscous_friction", 0.01),
                                                   short_windows.plate.model("joint_spring", SwingingPlate::SPRING)});
  short_windows.plate.flow.fitter.conclude(data, fits);
  for (std::size_t i = 0; i < 2; ++i) {
    fits[i].residual = short_windows.leaving(i == 0 ? 1.0 : 1.2);
    fits[i].covariance.setConstant(1e-12);
  }
  Round round;
  round.fits = fits;
  round.decision = decide(data, short_windows.windows.base, round.fits);
  ASSERT_GE(round.decision.chosen, 0);
  const auto chosen = [&] {
    return round.decision.ranking[std::size_t(round.decision.chosen)].fit->model.parts.back()->name;
  };
  ASSERT_EQ(chosen(), "joint_viscous_friction");
  prefer_what_follows_whole_runs(short_windows.plate.flow, short_windows.windows, round);
  EXPECT_EQ(chosen(), "joint_spring");
  ASSERT_EQ(round.refuted.size(), 1u);
  EXPECT_EQ(round.refuted[0].model.parts.back()->name, "joint_viscous_friction");
}

// In the shortest windows an effect has to close 60 % of a large misfit: 60 to 24.6 times the noise.
TEST(Follow, TheBestEffectExplainsLittleOfAMisfitThatIsLeft) {
  ShortWindows short_windows;
  EXPECT_FALSE(explains_little(short_windows.plate.flow, short_windows.windows,
                               short_windows.fit("joint_spring", SwingingPlate::SPRING, 24)));
  EXPECT_TRUE(explains_little(short_windows.plate.flow, short_windows.windows,
                              short_windows.fit("joint_viscous_friction", 0.01, 26)));
  short_windows.windows.base.residual = short_windows.leaving(5);  // so near the noise all are fitted to their end
  EXPECT_FALSE(explains_little(short_windows.plate.flow, short_windows.windows,
                               short_windows.fit("joint_viscous_friction", 0.01, 4.9)));
}

}  // namespace
}  // namespace pvg::diagnose
