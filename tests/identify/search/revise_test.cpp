// Effects that take the place of others
#include "host/identify/search/revise.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/identify/damped_pendulum.hpp"

namespace pvg::diagnose {
namespace {

bool holds(const std::vector<std::string>& labels, const std::string& label) {
  return std::find(labels.begin(), labels.end(), label) != labels.end();
}

// Where little passes alone, the spring is no candidate for the place of the center of mass unless what did not pass
// is.
TEST(Revised, WhatDidNotPassAloneIsTriedWhereFewDid) {
  DampedPendulum pendulum;
  Prepared prepared(pendulum.data);
  // found first: the center of mass for the spring, and friction beside it
  const Fit wrong = pendulum.fitted({"center_of_mass_offset", "joint_viscous_friction"});
  const StandIns first_round{{pendulum.fitted({"center_of_mass_offset"})},
                             {pendulum.fitted({"quadratic_drag"}), pendulum.fitted({"constant_force"}),
                              pendulum.fitted({"joint_coulomb_friction"}), pendulum.fitted({"joint_spring"})}};
  const Revision revision = revised(pendulum.flow, prepared, wrong, first_round, {});
  const Fit& found = revision.fit;
  ASSERT_EQ(found.model.parts.size(), 2u);
  EXPECT_EQ(found.model.parts[0]->name, "joint_spring");
  EXPECT_EQ(found.model.parts[1]->name, "joint_viscous_friction");
  EXPECT_NEAR(found.model.x[0], DampedPendulum::SPRING, 3 * std::sqrt(found.covariance(0, 0)));
  EXPECT_NEAR(rms(found.residual), 1, 0.1);
  EXPECT_EQ(revision.as_good, std::vector<std::string>{"joint_spring at hinge"});
  EXPECT_TRUE(holds(revision.worse, "center_of_mass_offset at bar"));
  EXPECT_TRUE(told_with_first({"center_of_mass_offset at bar", "retune_mass at bar"}, "center_of_mass_offset at bar",
                              "joint_spring at hinge", revision)
                  .empty());
}

// A center of mass, with three numbers, is nearer to the data than a spring whose fit stopped short.
TEST(Revised, AFitThatStoppedShortIsBegunAgainWhereOneWithMoreNumbersEnded) {
  DampedPendulum pendulum;
  Prepared prepared(pendulum.data);
  Model early = pendulum.fitted({"joint_spring", "joint_viscous_friction"}).model;
  early.x[0] = 0;
  std::vector<Fit> fits = pendulum.flow.fitter.begin(pendulum.data, {early});
  pendulum.flow.fitter.conclude(pendulum.data, fits);
  ASSERT_GT(rms(fits[0].residual), 10);
  const StandIns richer{{pendulum.fitted({"center_of_mass_offset"})}, {}};
  const Fit found = revised(pendulum.flow, prepared, fits[0], richer, {}).fit;
  ASSERT_EQ(found.model.parts, early.parts);
  EXPECT_NEAR(found.model.x[0], DampedPendulum::SPRING, 3 * std::sqrt(found.covariance(0, 0)));
  EXPECT_NEAR(rms(found.residual), 1, 0.1);
}

using Labels = std::vector<std::string>;

// Beside the second effect b is worse than a, c is as good, and d was not tried.
TEST(Revised, TheSetOfTheFirstEffectLosesWhatIsWorseBesideTheSecond) {
  const Revision revision{{}, {"a", "c"}, {"b"}};
  EXPECT_EQ(told_with_first({"b", "a", "d"}, "a", "a", revision), (Labels{"a", "d", "c"}));
  EXPECT_EQ(told_with_first({}, "a", "a", revision), (Labels{"a", "c"}));
  EXPECT_EQ(told_with_first({"b", "a"}, "a", "a", {{}, {"a"}, {"b"}}), Labels{});
  EXPECT_EQ(told_with_first({"b", "d"}, "b", "a", revision), (Labels{"a", "c"})) << "d mimics b, which is worse";
  EXPECT_EQ(told_with_first({"b", "a"}, "a", "a", {}), (Labels{"a", "b"})) << "nothing was tried";
}

TEST(StandIns, AreWhatDidNotPassOnlyWhereFewDid) {
  StandIns stand_ins{{Fit()}, {Fit(), Fit()}};
  EXPECT_EQ(stand_ins.all().size(), 3u);
  stand_ins.passed.resize(criteria().n_swaps);
  EXPECT_EQ(stand_ins.all().size(), criteria().n_swaps);
}

}  // namespace
}  // namespace pvg::diagnose
