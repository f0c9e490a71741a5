// What could be missing, and where it is looked for
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/sensing/question.hpp"
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

// Jobs of the same motion are simulated once, so each change of the scene has to show in what stands for its motion.
TEST(Candidates, OnlyErrorsOfTheMeasurementMoveNothing) {
  for (const std::string name :
       {"slide_retune_friction", "driven_backlash_30x", "hanging_strain_stiffening_10x", "tracked_latency_10x"}) {
    const Problem problem = make_problem(std::filesystem::path(PVG_DATA_FOLDER) / "hidden" / name / "recording.yaml");
    const Window window = make_windows(problem, false, 0, 1).at(0);
    const auto motion_of = [&](const Variant& variant) {
      const Job job{&variant, &window, window.initial, false};
      return questions_of(problem, {&job, 1}).at(0).motion;
    };
    const Variant base{problem.scene.scene, {}};
    const std::vector<RigidBody>& bodies = problem.scene.scene.rigid_bodies;
    std::vector<std::string> touching;
    if (bodies.size() > 1) touching.push_back(bodies[0].name + "/" + bodies[1].name);
    for (const Candidate& candidate : make_candidates(problem, touching)) {
      std::vector<double> values;
      for (const Parameter& p : candidate.parameters)
        values.push_back(p.off + p.scale <= p.high ? p.off + p.scale : p.off - p.scale);
      Variant changed = base;
      candidate.apply(changed, values);
      EXPECT_EQ(motion_of(changed) == motion_of(base), candidate.family == Family::measurement)
          << name << ": " << candidate.label();
    }
  }
}

// A scene of a bar on a hinge; what the hinge has besides follows.
const std::string PENDULUM = R"(schema: 1
name: pendulum
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: bar, kind: rigid, shape: {box: {size: [0.05, 0.05, 0.4]}}, mass: 0.8, pose: {position: [0, 0, -0.2]}, collides: false}
joints:
  - {name: hinge, type: revolute, parent: base, child: bar, axis: [0, 1, 0])";

// A pendulum that its joint damps swings by damping / mass alone: no motion tells which of the two is wrong. The mass
// may have been weighed. It remains likelier than an error of a sensor or a missing effect.
TEST(Candidates, OfAMassAndADampingTheDampingIsLikelierToBeWrong) {
  const TestFolder folder;
  folder.write("scene.yaml", PENDULUM + ", damping: 0.003}\n");
  std::string run = "t,q\n";
  for (int i = 0; i < 9; ++i) run += std::to_string(0.01 * i) + "," + std::to_string(0.1 - 0.001 * i * i) + "\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: q, kind: position, joint: hinge, unit: rad, noise: 0.001}
)");
  const std::vector<Candidate> candidates = make_candidates(make_problem(folder.path / "recording.yaml"), {});
  const auto log_prior_of = [&](const std::string& name) {
    const auto at = std::find_if(candidates.begin(), candidates.end(),
                                 [&](const Candidate& candidate) { return candidate.name == name; });
    return at == candidates.end() ? NAN : at->log_prior;
  };
  EXPECT_LT(log_prior_of("retune_mass"), log_prior_of("retune_joint_damping"));
  const double of_mass = log_prior_of("retune_mass") + criteria().log_prior_parameter;
  EXPECT_GT(of_mass, criteria().log_prior_measurement);
  EXPECT_GT(of_mass, log_prior_of("joint_viscous_friction") + criteria().log_prior_physical);
}

// The rate below which the friction of a hinge that was measured for 2 s is rounded off [rad/s]. channels: more of
// them.
double rounding_of_friction(const std::string& channels) {
  const TestFolder folder;
  folder.write("scene.yaml", PENDULUM + "}\n");
  std::string run = "t,q,w\n";
  for (int i = 0; i <= 20; ++i) run += std::to_string(0.1 * i) + "," + std::to_string(0.1 * i) + ",1\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml",
               "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n" + channels);
  const Problem problem = make_problem(folder.path / "recording.yaml");
  for (const Candidate& candidate : make_candidates(problem, {})) {
    if (candidate.name != "joint_coulomb_friction") continue;
    Variant variant{problem.scene.scene, {}};
    const double effort = 0.01;
    candidate.apply(variant, {&effort, 1});
    return variant.scene.effects.back().parameters.at(1);
  }
  return NAN;
}

// A tenth of what the noise hides: 0.5 mrad over 2 s are 0.25 mrad/s. A rate's own noise may hide less.
TEST(Candidates, FrictionOfAJointIsRoundedOffBelowWhatTheNoiseHides) {
  const std::string place = "  - {column: q, kind: position, joint: hinge, unit: rad, noise: 0.0005}\n";
  EXPECT_DOUBLE_EQ(rounding_of_friction(place), 2.5e-5);
  EXPECT_DOUBLE_EQ(
      rounding_of_friction(place + "  - {column: w, kind: rate, joint: hinge, unit: rad/s, noise: 1e-4}\n"), 1e-5);
  EXPECT_DOUBLE_EQ(rounding_of_friction("  - {column: q, kind: position, joint: hinge, unit: rad, noise: 0.1}\n"),
                   1e-3);
}

}  // namespace
}  // namespace pvg::diagnose
