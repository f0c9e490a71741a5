// What a reader is told of a recording before anything is simulated
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host/identify/data/problem.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// A joint swings twice by `amplitude` within a hundred samples; `step`: from a row to the next that is written, modulo
// 101
std::vector<std::string> warnings_of_a_swing(double amplitude, int step, const std::string& more_runs = "") {
  const TestFolder folder;
  folder.write("scene.yaml", R"(schema: 1
name: swing
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: bar, kind: rigid, shape: {box: {size: [0.02, 0.02, 0.2]}}, mass: 1, pose: {position: [0, 0, -0.1]}, collides: false}
joints:
  - {name: hinge, type: revolute, parent: base, child: bar, axis: [0, 1, 0]}
)");
  std::string rows = "t,q\n";
  for (int i = 0; i <= 100; ++i)
    rows += std::to_string(0.01 * i) + "," +
            std::to_string(amplitude * std::sin(0.04 * std::numbers::pi * (i * step % 101))) + "\n";
  folder.write("run.csv", rows);
  folder.write("silent.csv", "t,q\n0,\n0.1,nan\n0.2,\n0.3,\n0.4,\n0.5,\n0.6,\n0.7,\n0.8,\n");
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: run.csv, role: fit}
)" + more_runs + R"(channels:
  - {column: q, kind: position, joint: hinge, unit: rad, noise: 0.01}
)");
  return warnings(make_problem(folder.path));
}

bool asks_for_the_order(const std::vector<std::string>& sentences) {
  return std::any_of(sentences.begin(), sentences.end(), [](const std::string& sentence) {
    return sentence.find("are its rows in the order of time?") != std::string::npos;
  });
}

TEST(Warnings, AskForTheOrderOfRowsThatHaveNothingToDoWithTheirNeighbours) {
  EXPECT_FALSE(asks_for_the_order(warnings_of_a_swing(0.5, 1)));
  EXPECT_TRUE(asks_for_the_order(warnings_of_a_swing(0.5, 37)));
  EXPECT_FALSE(asks_for_the_order(warnings_of_a_swing(0.05, 37))) << "within ten times the noise";
}

TEST(Warnings, NameTheRunsInWhichAChannelHasNoSample) {
  const auto tells = [](const std::vector<std::string>& sentences) {
    return std::any_of(sentences.begin(), sentences.end(), [](const std::string& sentence) {
      return sentence.find("joint hinge has no sample in silent.csv") != std::string::npos;
    });
  };
  EXPECT_FALSE(tells(warnings_of_a_swing(0.5, 1)));
  EXPECT_TRUE(tells(warnings_of_a_swing(0.5, 1, "  - {file: silent.csv, role: fit}\n")));
}

}  // namespace
}  // namespace pvg::diagnose
