#include "host/physics/step/extrapolation.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

// two worlds of one node each
System two_nodes() {
  System system;
  system.node_ranges = {{0, 0, 1}, {1, 1, 2}};
  return system;
}

const std::vector<char> GOES_ON = {true, true};

TEST(Extrapolation, AnEvenChangeOfVelocityGoesOnInItsWorldAlone) {
  const std::vector<double> two_before = {0, 0, 1, 5, 0, 0}, before = {0.5, 0, 1, 5, 0, 0}, now = {1, 0, 1, 5, 0, 2};
  const std::vector<double> expected = {1.5, 0, 1, 5, 0, 2};
  EXPECT_EQ(extrapolated_velocities(two_nodes(), now, before, two_before, GOES_ON), expected);
}

TEST(Extrapolation, ADecayingChangeDecaysOn) {
  const std::vector<double> two_before = {0, 0, 0, 0, 0, 0}, before = {1, 0, 0, 0, 0, 0}, now = {1.5, 0, 0, 0, 0, 0};
  const std::vector<double> expected = {1.75, 0, 0, 0, 0, 0};
  EXPECT_EQ(extrapolated_velocities(two_nodes(), now, before, two_before, GOES_ON), expected);
}

TEST(Extrapolation, ChangesThatWereNotForetoldEnd) {
  // an impact in one world, a change that turns aside in the other
  const std::vector<double> two_before = {0, 0, -1, 0, 0, 0}, before = {0, 0, -1.1, 1, 0, 0},
                            now = {0, 0, 0, 1.5, 1, 0};
  EXPECT_EQ(extrapolated_velocities(two_nodes(), now, before, two_before, GOES_ON), now);
}

TEST(Extrapolation, AStepOfAnotherLengthForetellsNothing) {
  const std::vector<double> two_before = {0, 0, 0, 0, 0, 0}, before = {1, 0, 0, 1, 0, 0}, now = {2, 0, 0, 2, 0, 0};
  const std::vector<double> expected = {2, 0, 0, 3, 0, 0};
  EXPECT_EQ(extrapolated_velocities(two_nodes(), now, before, two_before, std::vector<char>{false, true}), expected);
}

}  // namespace
}  // namespace pvg
