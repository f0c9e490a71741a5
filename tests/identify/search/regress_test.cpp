#include "host/identify/search/regress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/identify/candidates/law_dictionary.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

using Subsets = std::vector<std::vector<std::size_t>>;

// columns that have nothing to do with each other: a column gains g^2 / (2 a)
TEST(BestSubsets, OfSeparateColumnsAreThoseThatGainMost) {
  Signatures signatures;
  signatures.a = Eigen::Vector4d(1, 1, 4, 1).asDiagonal();
  signatures.g = Eigen::Vector4d(0.5, -3, 4.1, -2);  // gains 0.125, 4.5, 2.1 and 2
  EXPECT_EQ(best_subsets(signatures, 2, 1), (Subsets{{1}, {1, 2}}));
  EXPECT_EQ(best_subsets(signatures, 1, 3), (Subsets{{1}, {2}, {3}}));
}

// the third column is the sum of the first two, and the data are 3 times the first less the second: together those two
// leave nothing, though the third alone is no worse than the second
TEST(BestSubsets, OfColumnsThatHangTogetherAreThoseThatExplainTogether) {
  Eigen::MatrixXd columns(3, 3);
  columns << 1, 0, 1, 0, 1, 1, 0, 0, 0.5;
  const Eigen::Vector3d data(3, -1, 0);
  Signatures signatures;
  signatures.a = columns.transpose() * columns;
  signatures.g = -columns.transpose() * data;
  const Subsets best = best_subsets(signatures, 2, 1);
  ASSERT_EQ(best.size(), 2u);
  EXPECT_EQ(best[0], Subsets::value_type{0});
  EXPECT_EQ(best[1], (Subsets::value_type{0, 1}));
}

TEST(BestSubsets, AreNoLargerThanThereAreColumns) {
  Signatures signatures;
  signatures.a = Eigen::MatrixXd::Identity(1, 1);
  signatures.g = Eigen::VectorXd::Ones(1);
  EXPECT_EQ(best_subsets(signatures, 3, 2), (Subsets{{0}}));
}

// A hinge and a free ball, both measured, each going from -0.2 to 0.8 at 2 per second.
std::filesystem::path recording(const TestFolder& folder) {
  folder.write("scene.yaml", R"(schema: 1
name: two
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 2, pose: {position: [0.3, 0, 0]}, collides: false}
  - {name: ball, kind: rigid, shape: {sphere: {radius: 0.05, subdivisions: 1}}, mass: 1, collides: false}
joints:
  - {name: hinge, type: revolute, parent: base, child: arm, axis: [0, 0, 1]}
)");
  std::string rows = "t,q,x,y,z\n";
  for (int i = 0; i <= 50; ++i) {
    const std::string t = std::to_string(0.01 * i), p = std::to_string(-0.2 + 0.02 * i);
    rows += t + "," + p + "," + p + ",0,0\n";
  }
  folder.write("run.csv", rows);
  folder.write("other.csv", rows + "0.51,0.82,0.82,0,0\n");  // a copy of the fitted run would be refused
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: run.csv, role: fit}
  - {file: other.csv, role: held_out}
channels:
  - {column: q, kind: position, joint: hinge, unit: rad, noise: 0.001}
  - {columns: [x, y, z], kind: position, body: ball, unit: m, noise: 0.001}
initial: first_sample
)");
  return folder.path;
}

TEST(LawDictionary, EveryLawOfEverySiteIsOneThatASceneTakes) {
  const TestFolder folder;
  const Problem problem = make_problem(recording(folder));
  const std::vector<LawSite> sites = law_sites(problem);
  ASSERT_EQ(sites.size(), 2u);  // the arm is carried: its joint stands for it
  EXPECT_EQ(sites[0].effect + " " + sites[0].target, "regressed_effort hinge");
  EXPECT_EQ(sites[1].effect + " " + sites[1].target, "regressed_force ball");
  for (const LawSite& site : sites) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < site.laws.size(); ++i) all.push_back(i);
    const Candidate whole = law_candidate(site, all);
    Variant variant{problem.scene.scene, {}};
    whole.apply(variant, std::vector<double>(all.size(), 0.5));
    EXPECT_NO_THROW(check_effects(variant.scene)) << site.target;
    EXPECT_EQ(variant.scene.effects.back().parameters.size(), site.laws.size());
  }
}

// A sledge whose place is measured goes from -0.2 to 0.8 m along its rail, at 0.5 m/s; windows begin each quarter of a
// second, so the middle of what they see is at 0.24 m.
TEST(LawDictionary, AJointThatPlacesOfItsBodyTellIsASite) {
  const TestFolder folder;
  folder.write("scene.yaml", R"(schema: 1
name: rail
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: sledge, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 2, pose: {position: [0.3, 0, 0]}, collides: false}
joints:
  - {name: rail, type: prismatic, parent: base, child: sledge, axis: [1, 0, 0]}
)");
  std::string rows = "t,x\n";
  for (int i = 0; i <= 200; ++i) rows += std::to_string(0.01 * i) + "," + std::to_string(0.1 + 0.005 * i) + "\n";
  folder.write("run.csv", rows);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: run.csv, role: fit}
channels:
  - {column: x, kind: position, body: sledge, axis: [1, 0, 0], unit: m, noise: 0.001}
initial: first_sample
)");
  const std::vector<LawSite> sites = law_sites(make_problem(folder.path));
  ASSERT_EQ(sites.size(), 1u);
  EXPECT_EQ(sites[0].effect + " " + sites[0].target + " " + sites[0].unit, "regressed_effort rail N");
  EXPECT_TRUE(std::any_of(sites[0].laws.begin(), sites[0].laws.end(), [](const Law& law) {
    double onset = 0;
    return std::sscanf(law.shown.c_str(), "fmax(q - %lf", &onset) == 1 && std::abs(onset - 0.24) < 0.02;
  }));
}

// A drag on v^2 of the other sign lets a motion grow beyond all bounds in a finite time.
TEST(LawDictionary, WhatGrowsWithTheSpeedBrakesWherePositive) {
  const TestFolder folder;
  const Problem problem = make_problem(recording(folder));
  std::size_t n_braking = 0;
  for (const LawSite& site : law_sites(problem))
    for (const Law& law : site.laws) {
      const std::string& text = law.shown;
      if (text.find("|v|") == std::string::npos && text.find("fabs(v)") == std::string::npos) continue;
      EXPECT_TRUE(text.starts_with("-")) << text;
      ++n_braking;
    }
  EXPECT_GE(n_braking, 3u);
}

TEST(LawDictionary, ASumIsWrittenWithItsNumbersInPlace) {
  const LawSite effort{
      "regressed_effort", "hinge", "N m", 1, {{{"1"}, "1"}, {{"q"}, "q"}, {{"sin(3 * q)"}, "sin(3 * q)"}}};
  EXPECT_EQ(shown_sum(effort, std::vector<std::size_t>{0, 2}, std::vector<double>{0.25, -0.3125}),
            "0.25 - 0.312 sin(3 * q)");
  const LawSite braking{"regressed_effort", "hinge", "N m", 1, {{{"-v"}, "-v"}, {{"q"}, "q"}}};
  EXPECT_EQ(shown_sum(braking, std::vector<std::size_t>{0, 1}, std::vector<double>{0.25, -2}), "-0.25 v - 2 q");
  EXPECT_EQ(law_candidate(effort, std::vector<std::size_t>{2, 1}).equation, "c0 * sin(3 * q) + c1 * q");
  const LawSite force{"regressed_force", "ball", "N", 1, {{{"0", "1", "0"}, "up"}, {{"x", "y", "0"}, "out"}}};
  Variant variant;
  law_candidate(force, std::vector<std::size_t>{0, 1}).apply(variant, std::vector<double>{2, 3});
  EXPECT_EQ(variant.scene.effects.back().formulas, (std::vector<std::string>{"c1 * x", "c0 + c1 * y", "0"}));
  EXPECT_EQ(variant.scene.effects.back().parameters, (std::vector<double>{2, 3}));
  const std::vector<std::string> formulas = variant.scene.effects.back().formulas;
  law_candidate(force, std::vector<std::size_t>{1}).apply(variant, std::vector<double>{3});
  EXPECT_EQ(variant.scene.effects.back().formulas, formulas) << "one kernel for all sums";
  EXPECT_EQ(variant.scene.effects.back().parameters, (std::vector<double>{0, 3}));
  EXPECT_EQ(law_effect(force, std::vector<std::size_t>{1}, std::vector<double>{3}).formulas,
            (std::vector<std::string>{"c0 * x", "c0 * y", "0"}));
}

}  // namespace
}  // namespace pvg::diagnose
