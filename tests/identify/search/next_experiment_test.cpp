// The next experiment: what counts as a separation, and which motions there are.
#include "host/identify/search/next_experiment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/identify/search/plan_next.hpp"
#include "tests/identify/driven_arm.hpp"

namespace pvg::diagnose {
namespace {

// A difference of 10 along a column that a parameter of prior 1 moves by 10 per deviation: it makes up for
// 10 - 10 / (1 + 100), at the price of its prior.
TEST(NextExperiment, WhatAParameterMakesUpForSeparatesNothing) {
  Eigen::VectorXd difference(2);
  difference << 10, 4;
  Eigen::MatrixXd column(2, 1);
  column << 10, 0;
  EXPECT_NEAR(separation_of(difference, column), std::hypot(10.0 / 101, 4), 1e-9);
  EXPECT_NEAR(separation_of(difference, Eigen::MatrixXd(2, 0)), std::hypot(10, 4), 1e-12);
}

// A drive that was told to go from 0 to 0.4 and back.
Problem driven() {
  Problem problem;
  problem.scene.scene.joints.resize(1);
  Joint& joint = problem.scene.scene.joints[0];
  joint.name = "shoulder";
  joint.type = Joint::Type::revolute;
  joint.drive.stiffness = 20;
  joint.parent = 0, joint.child = 1;
  problem.scene.scene.rigid_bodies.resize(2);
  problem.coordinates = {0};
  problem.can_restart = true;
  problem.channels.resize(1);
  problem.channels[0].joint = 0;
  problem.channels[0].sigma = 1e-3;
  diagnose::Run run;
  for (int i = 0; i < 100; ++i) run.t.push_back(0.02 * i);
  run.values = {std::vector<double>(100, 0.0)};
  run.noise_scale = {1};
  run.targets = {{{0, 1, 1.98}, {0, 0.4, 0}}};
  problem.runs = {run};
  problem.recording.runs.resize(1);
  return problem;
}

TEST(NextExperiment, CommandsStayWithinOneAndAHalfTimesWhatWasRecorded) {
  const Problem problem = driven();
  const std::vector<PlannedMotion> motions = motion_family(problem, all_inputs(problem.scene.scene));
  EXPECT_EQ(motions.size(), 4u * 3 * 3);
  std::set<std::string> descriptions;
  double most = 0;
  for (const PlannedMotion& motion : motions) {
    descriptions.insert(motion.description);
    EXPECT_EQ(motion.targets.at(0).value.front(), 0) << "begins where the recorded commands did";
    for (const double value : motion.targets[0].value) most = std::max(most, std::abs(value));
  }
  EXPECT_EQ(descriptions.size(), motions.size());
  EXPECT_NEAR(most, 0.6, 1e-3);
  const Problem planned = planned_problem(problem, motions);
  EXPECT_EQ(planned.runs.size(), motions.size());
  EXPECT_EQ(planned.runs[0].t.size(), 100u);
}

// What no command moves hangs on its drive as on a spring: it is released about where it hung, and motions of the
// recorded size also carry half the mass of what they move.
TEST(NextExperiment, ASpringIsReleasedAlsoWithALoad) {
  Problem problem = driven();
  PhysicalScene& scene = problem.scene.scene;
  scene.rigid_bodies[1].name = "weight";
  scene.rigid_bodies[1].mass = 0.4;
  diagnose::Run& run = problem.runs[0];
  run.targets = {{{0}, {0}}};
  for (std::size_t i = 0; i < run.t.size(); ++i) run.values[0][i] = 0.2 + 0.1 * std::cos(10 * run.t[i]);
  const std::vector<PlannedMotion> motions = motion_family(problem, all_inputs(scene));
  ASSERT_EQ(motions.size(), 6u + 1) << "six releases, one of them again with a load";
  double low = 1, high = 0;
  for (const PlannedMotion& motion : motions) {
    low = std::min(low, motion.initial.position[0]);
    high = std::max(high, motion.initial.position[0]);
    EXPECT_EQ(motion.initial.rate[0], 0);
  }
  EXPECT_NEAR(low, 0.2 - 1.5 * 0.1, 0.02);
  EXPECT_NEAR(high, 0.2 + 1.5 * 0.1, 0.02);
  const auto loaded = std::find_if(motions.begin(), motions.end(), [](const auto& motion) { return motion.load > 0; });
  ASSERT_NE(loaded, motions.end());
  EXPECT_DOUBLE_EQ(loaded->load, 0.2);
  EXPECT_NE(loaded->description.find("with a load of 0.2 kg on weight"), std::string::npos) << loaded->description;
  const Problem planned = planned_problem(problem, {motions[0], *loaded});
  EXPECT_TRUE(scene_of(planned, planned.runs[0]).effects.empty());
  const std::vector<Effect> effects = scene_of(planned, planned.runs[1]).effects;
  ASSERT_EQ(effects.size(), 1u);
  EXPECT_EQ(effects[0].name, "payload_mass");
  EXPECT_DOUBLE_EQ(effects[0].parameters[0], 0.2);
}

TEST(NextExperiment, TellingMoreNamesApartIsWorthMore) {
  EXPECT_GT(worth_of({3, 3}), worth_of({300, 0.1}));
  EXPECT_GT(worth_of({5, 0.1}), worth_of({4, 0.1}));
  EXPECT_GT(worth_of({12}), worth_of({11}));
}

// Seven links, one carried by the other, each by a driven joint of the same number.
Problem driven_chain() {
  Problem problem = driven();
  PhysicalScene& scene = problem.scene.scene;
  const Joint first = scene.joints[0];
  scene.joints.clear();
  scene.rigid_bodies.resize(8);
  problem.coordinates.clear();
  diagnose::Run& run = problem.runs[0];
  run.targets.assign(7, TargetTable(run.targets[0]));
  for (int j = 0; j < 7; ++j) {
    scene.joints.push_back(first);
    scene.joints.back().name = "joint" + std::to_string(j + 1);
    scene.joints.back().parent = j, scene.joints.back().child = j + 1;
    scene.rigid_bodies[std::size_t(j) + 1].name = "link" + std::to_string(j + 1);
    problem.coordinates.push_back(j);
  }
  return problem;
}

Candidate candidate_at(const std::string& name, const std::string& target) {
  Candidate candidate;
  candidate.name = name;
  candidate.target = target;
  return candidate;
}

RankedModel ranked_model(std::vector<const Candidate*> parts) {
  RankedModel model;
  model.parts = std::move(parts);
  return model;
}

std::vector<PlannedMotion> between_two(const Problem& problem, const RankedModel& first, const RankedModel& second) {
  return motions_between(problem, first, {&second});
}

std::set<std::string> commanded(const std::vector<PlannedMotion>& motions) {
  std::set<std::string> names;
  for (const PlannedMotion& motion : motions)
    names.insert(motion.description.substr(11, motion.description.find(':') - 11));
  return names;
}

TEST(NextExperiment, MovesOnlyWhatIsInDoubt) {
  const Problem problem = driven_chain();
  const Candidate coulomb = candidate_at("joint_coulomb_friction", "joint4");
  const Candidate stribeck = candidate_at("joint_stribeck_friction", "joint4");
  const Candidate viscous = candidate_at("joint_viscous_friction", "joint2");
  const Candidate drag = candidate_at("linear_drag", "link3"), tilt = candidate_at("gravity_tilt", "scene");
  const auto between = [&](std::vector<const Candidate*> first, std::vector<const Candidate*> second) {
    return commanded(between_two(problem, ranked_model(std::move(first)), ranked_model(std::move(second))));
  };
  using Names = std::set<std::string>;
  EXPECT_EQ(between({&viscous, &coulomb}, {&viscous, &stribeck}), (Names{"joint3", "joint4", "joint5"}));
  const RankedModel one = ranked_model({&coulomb}), other = ranked_model({&stribeck});
  EXPECT_NE(between_two(problem, one, other).front().description.find("joint4"), std::string::npos)
      << "where the doubt is comes first";
  EXPECT_EQ(between({&viscous}, {&drag}), (Names{"joint1", "joint2", "joint3"}));
  EXPECT_EQ(between({&viscous}, {&tilt}).size(), 7u) << "gravity acts on all";
}

TEST(NextExperiment, MovesEverythingWhereWhatIsInDoubtWasNeverMoved) {
  Problem problem = driven_chain();
  for (const std::size_t j : {2, 3, 4}) problem.runs[0].targets[j].value = {0, 0, 0};
  const Candidate coulomb = candidate_at("joint_coulomb_friction", "joint4");
  const Candidate stribeck = candidate_at("joint_stribeck_friction", "joint4");
  EXPECT_EQ(commanded(between_two(problem, ranked_model({&coulomb}), ranked_model({&stribeck}))),
            (std::set<std::string>{"joint1", "joint2", "joint6", "joint7"}));
}

// An arm on a drive of 20 N m/rad that was told to swing: c = 0.1 N m s/rad of friction or 0.02 N m at every rate?
struct ConfusedFrictions {
  const TestFolder folder;
  Device device;
  Settings settings;
  Diagnosis found;
  const Problem problem = recorded();
  const std::vector<Candidate> candidates = make_candidates(problem, {});

  ConfusedFrictions() {
    found.base = {problem.scene.scene, {}};
    found.ranking = {friction("joint_viscous_friction", {0.1}), friction("joint_coulomb_friction", {0.02})};
    found.inseparable = {{found.ranking[0].parts[0]->label(), found.ranking[1].parts[0]->label()}};
  }

  RankedModel friction(const std::string& name, const std::vector<double>& values) const {
    const auto at =
        std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) { return c.name == name; });
    RankedModel model = ranked_model({&*at});
    model.values = values;
    model.deviations.assign(values.size(), 0.1 * values[0]);
    return model;
  }

  Problem recorded() const {
    folder.write("scene.yaml", driven_arm("10 ms", "{stiffness: 20, damping: 0.6, target: 0}"));
    std::string run = "t,command,q\n";
    for (int i = 0; i < 40; ++i) {
      const std::string angle = std::to_string(0.3 * std::sin(0.2 * i));
      run += std::to_string(0.01 * i) + "," + angle + "," + angle + "\n";
    }
    write_driven_recording(folder, run, "initial: {joint/shoulder/position: 0, joint/shoulder/velocity: 0}\n");
    return make_problem(folder.path / "recording.yaml");
  }
};

TEST(PlanNext, IsDoneAfterTheDiagnosisInWhatIsLeftOfItsMinutes) {
  ConfusedFrictions confused;
  Diagnosis hurried = confused.found;
  hurried.seconds = 60 * confused.settings.minutes;
  plan_next(confused.device, confused.problem, confused.settings, hurried);
  EXPECT_TRUE(hurried.next_experiment.empty());
  ASSERT_EQ(hurried.left_out.size(), 1u);
  EXPECT_NE(hurried.left_out[0].find("0 of 48 motions were simulated in 0 s"), std::string::npos)
      << hurried.left_out[0];
  EXPECT_LT(hurried.seconds, 60 * confused.settings.minutes + 5);
  confused.settings.minutes = 60;
  plan_next(confused.device, confused.problem, confused.settings, confused.found);
  EXPECT_NE(confused.found.next_experiment.find("of 48 motions the most"), std::string::npos)
      << confused.found.next_experiment;
  EXPECT_TRUE(confused.found.left_out.empty());
  ASSERT_TRUE(confused.found.next_motion);
  EXPECT_EQ(confused.found.next_motion->targets.size(), 1u);
}

TEST(PlanNext, NamesAreConfusedOrItIsAskedFor) {
  ConfusedFrictions confused;
  EXPECT_TRUE(wants_next(confused.settings, confused.found));
  confused.found.inseparable.clear();
  EXPECT_FALSE(wants_next(confused.settings, confused.found));
  confused.settings.plans_next = true;
  EXPECT_TRUE(wants_next(confused.settings, confused.found));
  confused.found.ranking.resize(1);
  EXPECT_FALSE(wants_next(confused.settings, confused.found)) << "there is nothing to tell it from";
}

}  // namespace
}  // namespace pvg::diagnose
