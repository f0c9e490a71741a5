// Where a run begins, by its first samples
#include "host/identify/data/window.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/identify/driven_arm.hpp"

namespace pvg::diagnose {
namespace {

constexpr double NOISE = 0.001;  // as write_driven_recording states it [rad]

// Position and rate of the arm at the beginning of a run of 40 samples at 100 Hz.
InitialState start_of(const std::function<double(int)>& angle) {
  const TestFolder folder;
  folder.write("scene.yaml", driven_arm("5 ms", "{stiffness: 10, damping: 1}"));
  std::string run = "t,command,q\n";
  for (int i = 0; i < 40; ++i) run += std::to_string(0.01 * i) + ",0," + std::to_string(angle(i)) + "\n";
  write_driven_recording(folder, run);
  return make_windows(make_problem(folder.path / "recording.yaml"), false, 0, 1).front().initial;
}

// Noise of which the first five samples happen to rise: by them alone the arm turns at 0.1 rad/s.
double noise_that_rises(int i) { return i < 5 ? NOISE * (i - 2) : i % 2 ? NOISE : -NOISE; }

TEST(WindowStart, OfARunThatRestsIsAtRestThoughFewSamplesRise) {
  const InitialState start = start_of([](int i) { return 0.4 + noise_that_rises(i); });
  EXPECT_EQ(start.rate[0], 0);
  EXPECT_NEAR(start.position[0], 0.4, NOISE / 2);
}

TEST(WindowStart, OfARunThatMovesMovesThoughSlowly) {
  const InitialState start = start_of([](int i) { return 0.4 + 0.08 * 0.01 * i; });  // 11 times the noise in 15 samples
  EXPECT_NEAR(start.rate[0], 0.08, 1e-6);
  EXPECT_NEAR(start.position[0], 0.4, 1e-6);
}

// At rest and let go: its place is that of the first sample, not the mean of the first fifteen.
TEST(WindowStart, OfAnArmThatIsLetGoIsWhereItWasLetGo) {
  const InitialState start = start_of([](int i) { return 0.4 - 2 * 0.0001 * i * i; });
  EXPECT_NEAR(start.rate[0], 0, 1e-6);
  EXPECT_NEAR(start.position[0], 0.4, 1e-6);
}

}  // namespace
}  // namespace pvg::diagnose
