// Effects that take the place of others
#include "host/identify/search/revise.hpp"

#include <gtest/gtest.h>

#include "tests/identify/damped_pendulum.hpp"

namespace pvg::diagnose {
namespace {

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
  const Fit found = revised(pendulum.flow, prepared, wrong, first_round, {});
  ASSERT_EQ(found.model.parts.size(), 2u);
  EXPECT_EQ(found.model.parts[0]->name, "joint_spring");
  EXPECT_EQ(found.model.parts[1]->name, "joint_viscous_friction");
  EXPECT_NEAR(found.model.x[0], DampedPendulum::SPRING, 3 * std::sqrt(found.covariance(0, 0)));
  EXPECT_NEAR(rms(found.residual), 1, 0.1);
}

TEST(StandIns, AreWhatDidNotPassOnlyWhereFewDid) {
  StandIns stand_ins{{Fit()}, {Fit(), Fit()}};
  EXPECT_EQ(stand_ins.all().size(), 3u);
  stand_ins.passed.resize(criteria().n_swaps);
  EXPECT_EQ(stand_ins.all().size(), criteria().n_swaps);
}

}  // namespace
}  // namespace pvg::diagnose
