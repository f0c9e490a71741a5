// Whether anything is left to be explained
#include "host/identify/search/prove.hpp"

#include <gtest/gtest.h>

#include "tests/identify/damped_pendulum.hpp"

namespace pvg::diagnose {
namespace {

// The center of mass in the place of a spring leaves 1.16 times the noise in swings of 1 rad, and 20 times in one of
// 1.8 rad.
TEST(Explained, IsNotWhatHeldOutRunsContradict) {
  DampedPendulum pendulum;
  const Fit wrong = pendulum.fitted({"center_of_mass_offset", "joint_viscous_friction"});
  ASSERT_LT(rms(wrong.residual), criteria().unexplained);
  EXPECT_FALSE(is_explained(pendulum.flow, pendulum.data, wrong, 0));
  ASSERT_EQ(pendulum.flow.notes.size(), 1u);
  EXPECT_NE(pendulum.flow.notes[0].find("held-out"), std::string::npos);
}

TEST(Explained, IsWhatLeavesTheNoise) {
  DampedPendulum pendulum;
  EXPECT_TRUE(
      is_explained(pendulum.flow, pendulum.data, pendulum.fitted({"joint_spring", "joint_viscous_friction"}), 0));
  EXPECT_TRUE(pendulum.flow.notes.empty());
}

}  // namespace
}  // namespace pvg::diagnose
