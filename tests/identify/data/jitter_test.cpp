// Time stamps that are wrong by a little
#include "host/identify/data/jitter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/base/error.hpp"
#include "host/identify/fit/fit.hpp"
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

// A plate that turns at 30 rad/s, seen with 0.5 mrad of noise and 0.1 ms of jitter, which is six times as much.
Problem turning(const TestFolder& folder, const std::string& said) {
  folder.write("scene.yaml", R"(schema: 1
name: turning
time_step: 5 ms
gravity: [0, 0, 0]
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: plate, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.02]}}, mass: 1, collides: false}
joints:
  - {name: spindle, type: revolute, parent: base, child: plate, axis: [0, 0, 1]}
)");
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  std::string run = "t,q\n";
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.01 * i;
    run += std::to_string(t) + "," + std::to_string(30 * (t + JITTER * normal(engine)) + 5e-4 * normal(engine)) + "\n";
  }
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, )" + said + "}\n");
  return make_problem(folder.path / "recording.yaml");
}

double error_of(const std::string& said) {
  const TestFolder folder;
  const Problem problem = turning(folder, said);
  Device device;
  Predictor predictor(device, problem);
  Fitter fitter(predictor, Variant{problem.scene.scene, {}});
  const FitData data = fitter.prepare(make_windows(problem, false, 0, 1), Model{});
  return rms(fitter.fit(data, {Model{}}, 4).front().residual);
}

TEST(Jitter, ThatIsStatedIsPartOfTheNoise) {
  EXPECT_NEAR(error_of("noise: 0.0005, jitter: 0.1 ms"), 1, 0.15);
  EXPECT_GT(error_of("noise: 0.0005"), 4);
}

TEST(Jitter, BesideANoiseThatIsMeasuredIsRefused) {
  const TestFolder folder;
  expect_error<UsageError>([&] { turning(folder, "noise: unknown, jitter: 0.1 ms"); },
                           {"jitter", "needs a number for `noise`"});
}

}  // namespace
}  // namespace pvg::diagnose
