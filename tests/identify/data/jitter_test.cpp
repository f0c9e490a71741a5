// Time stamps that are wrong by a little
#include "host/identify/data/jitter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double JITTER = 1e-4;  // [s]

TEST(Jitter, AddsTheRateTimesTheTimeOfAStamp) {
  Channel channel;
  channel.jitter = JITTER;
  const double none = std::nan("");
  // at rest, then 30 rad/s; one sample is missing
  const std::vector<double> noise = jitter_noise(channel, {0, 0.1, 0.2, 0.3, 0.4, 0.5}, {1, 1, 1, none, 7, 10});
  ASSERT_EQ(noise.size(), 6u);
  EXPECT_EQ(noise[0], 0);
  EXPECT_EQ(noise[1], 0);
  EXPECT_NEAR(noise[2], JITTER * 6 / 0.3, 1e-12);
  EXPECT_EQ(noise[3], 0);
  EXPECT_NEAR(noise[5], JITTER * 30, 1e-12);
  channel.jitter = 0;
  EXPECT_TRUE(jitter_noise(channel, {0, 1}, {1, 2}).empty());
}

TEST(Jitter, OfATurnIsThatOfItsRateWhateverTheSignOfItsQuaternion) {
  Channel channel;
  channel.jitter = JITTER;
  channel.width = 4;
  channel.n = 3;
  const double half = 0.5 * 0.02;
  const std::vector<double> noise =
      jitter_noise(channel, {0, 0.01}, {0, 0, 0, 1, 0, 0, -std::sin(half), -std::cos(half)});
  ASSERT_EQ(noise.size(), 6u);
  for (const double one : noise) EXPECT_NEAR(one, JITTER * 2, 1e-6);
}

// A plate whose recording says this of its channel.
Problem said_of_a_channel(const TestFolder& folder, const std::string& said) {
  folder.write("scene.yaml", R"(schema: 1
name: turning
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: plate, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.02]}}, mass: 1, collides: false}
joints:
  - {name: spindle, type: revolute, parent: base, child: plate, axis: [0, 0, 1]}
)");
  folder.write("a.csv", "t,q\n0,0\n0.01,0.1\n0.02,0.3\n0.03,0.3\n0.04,0.3\n0.05,0.3\n0.06,0.3\n0.07,0.3\n");
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, )" +
                                     said + "}\n");
  return make_problem(folder.path / "recording.yaml");
}

TEST(Jitter, IsReadFromTheRecording) {
  const TestFolder folder;
  const Problem problem = said_of_a_channel(folder, "noise: 0.0005, jitter: 0.1 ms");
  const diagnose::Run& run = problem.runs.at(0);
  EXPECT_NEAR(noise_of_number(problem, run, 0, 1, 0), std::hypot(5e-4, 1e-4 * 15), 1e-12);
  EXPECT_NEAR(noise_around(problem, run, 0, 0.02), std::hypot(5e-4, 1e-4 * 15), 1e-12);
  const Problem without = said_of_a_channel(folder, "noise: 0.0005");
  EXPECT_EQ(noise_of_number(without, without.runs.at(0), 0, 1, 0), 5e-4);
}

TEST(Jitter, BesideANoiseThatIsMeasuredIsRefused) {
  const TestFolder folder;
  expect_error<UsageError>([&] { said_of_a_channel(folder, "noise: unknown, jitter: 0.1 ms"); },
                           {"jitter", "needs a number for `noise`"});
}

}  // namespace
}  // namespace pvg::diagnose
