// Where a run begins, by its first samples
#include "host/identify/data/window.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "host/identify/data/start_fit.hpp"
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

// A ball that falls, hits the floor at 0.25 s and rises again, seen at 200 Hz with an error of half a millimetre
LocalFit start_near_an_impact(double t0) {
  std::vector<double> t, z;
  for (int i = 0; i < 100; ++i) {
    const double after = 0.005 * i - 0.25;  // the impact [s]
    t.push_back(0.005 * i);
    z.push_back((after < 0 ? -2.4 : 1.7) * after - 4.905 * after * after + (i % 2 ? 5e-4 : -5e-4));
  }
  return fit_around(t, z, 1, 0, t0, 5e-4);
}

TEST(WindowStart, JustBesideAnImpactIsThatOfItsOwnSide) {
  EXPECT_NEAR(start_near_an_impact(0.26).slope, 1.7 - 9.81 * 0.01, 0.05);  // both sides: 0.6 m/s
  EXPECT_NEAR(start_near_an_impact(0.24).slope, -2.4 + 9.81 * 0.01, 0.05);
  EXPECT_NEAR(start_near_an_impact(0.26).value, 1.7 * 0.01 - 4.905e-4, 1e-3);
}

// Its parabola leaves more than the noise, one through the later side does not: but it has no kink, a quartic follows
// it.
TEST(WindowStart, OfAFastSwingIsThatOfBothSides) {
  std::vector<double> t, z;
  for (int i = 0; i < 100; ++i) t.push_back(0.005 * i), z.push_back(std::sin(20 * t.back()));
  const LocalFit stated = fit_around(t, z, 1, 0, 0.2, 2e-3), known = fit_around(t, z, 1, 0, 0.2, 1);
  EXPECT_EQ(stated.slope, known.slope);
}

// Noise of five times what is stated is no kink.
TEST(WindowStart, OfBadNoiseIsThatOfBothSides) {
  std::vector<double> t, z;
  for (int i = 0; i < 100; ++i) t.push_back(0.005 * i), z.push_back(0.3 * t.back() + 1e-3 * ((i * 7919) % 11 - 5.0));
  const LocalFit stated = fit_around(t, z, 1, 0, 0.25, 5e-4), known = fit_around(t, z, 1, 0, 0.25, 1);
  EXPECT_EQ(stated.slope, known.slope);
}

}  // namespace
}  // namespace pvg::diagnose
