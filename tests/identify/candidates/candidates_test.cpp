// What could be missing, and where it is looked for
#include <gtest/gtest.h>

#include <algorithm>

#include "host/identify/candidates/candidate.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

std::vector<std::string> targets_of(const std::vector<Candidate>& candidates, const std::string& name) {
  std::vector<std::string> targets;
  for (const Candidate& candidate : candidates)
    if (candidate.name == name) targets.push_back(candidate.target);
  return targets;
}

Problem ball_on_a_floor(const TestFolder& folder) {
  folder.write("scene.yaml", R"(schema: 1
name: roll
time_step: 5 ms
bodies:
  - {name: floor, kind: half_space, normal: [0, 0, 1]}
  - {name: ball, kind: rigid, shape: {sphere: {radius: 0.05, subdivisions: 1}}, mass: 0.4, pose: {position: [0, 0, 0.06]}}
  - {name: tray, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.01]}}, mass: 0.4, pose: {position: [0, 0, 0.2]}}
)");
  std::string run = "t,x,y,z\n";
  for (int i = 0; i < 9; ++i) run += std::to_string(0.01 * i) + "," + std::to_string(0.01 * i) + ",0,0.06\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {columns: [x, y, z], kind: position, body: ball, unit: m, noise: 0.0005}
)");
  return make_problem(folder.path / "recording.yaml");
}

TEST(Candidates, WhatRollsIsBrakedWhicheverBodyOfThePairItIs) {
  const TestFolder folder;
  const Problem problem = ball_on_a_floor(folder);
  const auto rolling = [&](const std::string& pair) {
    return targets_of(make_candidates(problem, {pair}), "rolling_resistance");
  };
  EXPECT_EQ(rolling("floor/ball"), std::vector<std::string>{"ball/floor"});
  EXPECT_EQ(rolling("ball/floor"), std::vector<std::string>{"ball/floor"});
  EXPECT_EQ(rolling("ball/tray"), (std::vector<std::string>{"ball/tray", "tray/ball"}));
  EXPECT_EQ(targets_of(make_candidates(problem, {"floor/ball"}), "adhesion"), std::vector<std::string>{"floor/ball"});
}

}  // namespace
}  // namespace pvg::diagnose
