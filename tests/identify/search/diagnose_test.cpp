#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <thread>

#include "host/base/error.hpp"
#include "host/geometry/embedded_point.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "host/geometry/tet_embedding.hpp"
#include "host/geometry/tet_mesh.hpp"
#include "host/identify/candidates/candidate.hpp"
#include "host/identify/data/noise.hpp"
#include "host/identify/data/window.hpp"
#include "host/identify/fit/held_out.hpp"
#include "host/identify/search/localise.hpp"
#include "host/identify/search/workflow.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

TEST(Noise, ThirdDifferencesOfANoisyParabolaTellItsSigma) {
  std::mt19937 engine(1);
  std::normal_distribution<double> noise(0, 0.003);
  std::vector<double> values;
  for (int i = 0; i < 3000; ++i) values.push_back(2 - 0.1 * i + 1e-3 * i * i + noise(engine));
  EXPECT_NEAR(noise_of(values, 1), 0.003, 0.0003);
}

// What a moving mean over five samples leaves of white noise is sigma / sqrt(5); neighbours, which share four of the
// five, differ by less: third differences of neighbours alone would give a fifth of it.
TEST(Noise, OfASmoothedRecordingIsToldFromSamplesThatAreApart) {
  std::mt19937 engine(1);
  std::normal_distribution<double> noise(0, 0.003);
  std::vector<double> white, values;
  for (int i = 0; i < 3000; ++i) white.push_back(noise(engine));
  for (int i = 2; i < 2998; ++i) {
    const double mean = std::accumulate(&white[std::size_t(i) - 2], &white[std::size_t(i) + 3], 0.0) / 5;
    values.push_back(2 - 0.1 * i + 1e-3 * i * i + mean);
  }
  EXPECT_NEAR(noise_of(values, 1), 0.003 / std::sqrt(5.0), 0.0002);
}

TEST(Noise, AFastMotionSeenWellIsNotTakenForNoise) {
  std::vector<double> values;
  for (int i = 0; i < 300; ++i) values.push_back(std::sin(0.2 * i));
  EXPECT_LT(noise_of(values, 1), 0.003);  // 0.2^3 / sqrt(20), its own third differences
}

TEST(Noise, ACoarseSensorIsNoBetterThanItsDigits) {
  std::vector<double> values;
  for (int i = 0; i < 200; ++i) values.push_back(0.01 * std::round(0.13 * i));
  EXPECT_GE(noise_of(values, 1), 0.01 / std::sqrt(12.0) * 0.999);
}

// Two runs with noise of 1 mrad, one with 4: the channel has what most runs have, the noisy run four times as much.
TEST(Noise, ARunWithMoreNoiseHasANoiseScaleOfItsOwn) {
  std::mt19937 engine(1);
  Problem problem;
  problem.channels.resize(1);
  for (const double sigma : {1e-3, 4e-3, 1e-3}) {
    std::normal_distribution<double> noise(0, sigma);
    diagnose::Run run;
    run.noise_scale = {1};
    run.values.emplace_back();
    for (int i = 0; i < 2000; ++i) {
      run.t.push_back(0.01 * i);
      run.values[0].push_back(0.1 * std::sin(0.01 * i) + noise(engine));
    }
    problem.runs.push_back(std::move(run));
  }
  measure_noise(problem);
  EXPECT_NEAR(problem.channels[0].sigma, 1e-3, 1e-4);
  EXPECT_EQ(problem.runs[0].noise_scale[0], 1);
  EXPECT_NEAR(problem.runs[1].noise_scale[0], 4, 0.4);
  EXPECT_EQ(problem.runs[2].noise_scale[0], 1);
}

// A fast motion that is seen well has large third differences, which hang together: no noise of its own.
TEST(Noise, AFasterRunHasNoNoiseScaleOfItsOwn) {
  Problem problem;
  problem.channels.resize(1);
  for (const double rate : {0.02, 0.6, 0.02}) {
    diagnose::Run run;
    run.noise_scale = {1};
    run.values.emplace_back();
    for (int i = 0; i < 2000; ++i) {
      run.t.push_back(0.01 * i);
      run.values[0].push_back(std::sin(rate * i));
    }
    problem.runs.push_back(std::move(run));
  }
  measure_noise(problem);
  EXPECT_EQ(problem.runs[1].noise_scale[0], 1);
}

// Twenty windows that a model brings from 10 to 1, one that it cannot bring below 60: someone pushed. Where it halves
// the error it explains something, and where three of twenty are wrong the model is.
TEST(HeldOut, AWindowThatNothingExplainsDoesNotCount) {
  const auto windows = [](double usual, std::vector<double> others) {
    std::vector<Eigen::VectorXd> residual;
    for (const double r : others) residual.push_back(Eigen::VectorXd::Constant(5, r));
    while (residual.size() < 20) residual.push_back(Eigen::VectorXd::Constant(5, usual));
    return residual;
  };
  const auto n_counted = [&](const std::vector<double>& before, const std::vector<double>& after) {
    const std::vector<bool> counts = undisturbed(windows(10, before), windows(1, after));
    return std::count(counts.begin(), counts.end(), true);
  };
  EXPECT_EQ(n_counted({60}, {60}), 19);
  EXPECT_EQ(n_counted({60}, {20}), 20);
  EXPECT_EQ(n_counted({10}, {4}), 20);
  EXPECT_EQ(n_counted({60, 60}, {60, 60}), 18);
  EXPECT_EQ(n_counted({60, 60, 60}, {60, 60, 60}), 20);
  EXPECT_EQ(n_counted({40}, {60}), 20) << "the model made it worse";
}

TEST(Localise, TailsOfChiSquaredAreThoseOfTables) {
  EXPECT_NEAR(chi_squared_tail(18.307, 10), 0.05, 0.001);
  EXPECT_NEAR(chi_squared_tail(124.342, 100), 0.05, 0.001);
  EXPECT_NEAR(chi_squared_tail(23.209, 10), 0.01, 0.0005);
}

TEST(EmbeddedPoint, WeightsReproduceThePointEvenOutside) {
  const TetMesh bar = box_solid(Vec3(0.2, 0.1, 0.1), {3, 2, 2}, 10);
  for (const Vec3& point : {Vec3(0.03, -0.02, 0.04), Vec3(0.12, 0.06, 0)}) {
    Vec3 sum = Vec3::Zero();
    for (const auto& [node, weight] : embed(bar, point)) sum += weight * bar.points[node];
    EXPECT_LT((sum - point).norm(), 1e-12);
  }
}

// A marker that lies on a bent surface must stay on it, also where an element has nodes between its corners.
TEST(EmbeddedPoint, AMarkerMovesWithTheSeenSurface) {
  const TetMesh bar = make_quadratic(box_solid(Vec3(0.2, 0.1, 0.1), {3, 2, 2}, 4));
  std::vector<Vec3> bent = bar.points;
  for (Vec3& p : bent) p.z() += 4 * p.x() * p.x();
  for (const Vec3& point : {Vec3(0.031, -0.022, 0.05), Vec3(0.083, 0.05, 0.011), Vec3(0.104, 0.03, 0)}) {
    Vec3 marker = Vec3::Zero();
    for (const auto& [node, weight] : embed(bar, point)) marker += weight * bent[node];
    const Vec3 seen = multiply(embed_points(bar, std::span(&point, 1)).weights, bent)[0];
    EXPECT_LT((marker - seen).norm(), 1e-12);
  }
}

TEST(CanMove, WhatIsFixedOrPrescribedOrAHalfSpaceCannot) {
  RigidBody body;
  EXPECT_TRUE(can_move(body));
  for (bool RigidBody::*flag : {&RigidBody::is_fixed, &RigidBody::is_prescribed, &RigidBody::is_half_space}) {
    RigidBody other;
    other.*flag = true;
    EXPECT_FALSE(can_move(other));
  }
}

// scene of a hinge and a rail on it, one run of the hinge
std::filesystem::path chain(const TestFolder& folder, const std::string& channel) {
  folder.write("scene.yaml", R"(schema: 1
name: chain
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, pose: {position: [0.3, 0, 0]}, collides: false}
  - {name: cart, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, pose: {position: [0.5, 0.1, 0]}, collides: false}
joints:
  - {name: hinge, type: revolute, parent: base, child: arm, axis: [0, 0, 1]}
  - {name: rail, type: prismatic, parent: arm, child: cart, axis: [1, 0, 0], parent_frame: {position: [0.1, 0, 0]}}
)");
  std::string run = "t,q,p,r\n";
  for (int i = 0; i < 20; ++i)
    run += std::to_string(0.01 * i) + "," + std::to_string(0.2 + 0.03 * i) + "," + std::to_string(0.002 * i) + ",1\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml",
               "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n" + channel);
  return folder.path;
}

const std::string BOTH =
    "  - {column: q, kind: position, joint: hinge, unit: rad, noise: 0.001}\n"
    "  - {column: p, kind: position, joint: rail, unit: m, noise: 0.001}\n";

TEST(Window, BodiesOfAChainStartWithTheVelocitiesOfTheirCoordinates) {
  const TestFolder folder;
  const Problem problem = make_problem(chain(folder, BOTH));
  EXPECT_TRUE(problem.can_restart);
  InitialState state = make_windows(problem, false, 0, 1).at(0).initial;
  EXPECT_NEAR(state.position[0], 0.2, 1e-6);
  EXPECT_NEAR(state.rate[0], 3, 1e-4);
  EXPECT_NEAR(state.rate[1], 0.2, 1e-4);
  Scene now = problem.scene.scene, later = problem.scene.scene;
  start_at(problem, state, now);
  const double dt = 1e-6;
  state.position[0] += dt * state.rate[0];
  state.position[1] += dt * state.rate[1];
  start_at(problem, state, later);
  for (const std::size_t b : {1, 2}) {
    const Vec3 moved = later.rigid_bodies[b].pose.translation() - now.rigid_bodies[b].pose.translation();
    EXPECT_LT((moved / dt - now.rigid_bodies[b].velocity).norm(), 1e-5);
    EXPECT_LT((now.rigid_bodies[b].angular_velocity - Vec3(0, 0, 3)).norm(), 1e-3);
  }
}

TEST(Problem, ARecordingThatDoesNotFitItsSceneIsRefusedInOneSentence) {
  const TestFolder folder;
  const auto refused = [&](const std::string& channel, std::initializer_list<const char*> words) {
    expect_error<UsageError>([&] { make_problem(chain(folder, channel)); }, words);
  };
  refused("  - {columns: [q, p, r], kind: position, body: crate, unit: m}\n", {"`crate`", "does not have", "cart"});
  refused("  - {column: q, kind: position, joint: elbow, unit: rad}\n", {"`elbow`", "does not have"});
  refused("  - {column: q, kind: position, joint: hinge, unit: mm}\n", {"unit", "`mm`", "deg"});
  refused("  - {column: r, kind: position, joint: hinge, unit: rad}\n", {"constant"});
  refused("  - {columns: [q, p, r], kind: position, body: base, unit: m}\n", {"nothing is measured that can move"});
}

// A free body has twelve numbers at its start, each a world more per window, and waits at its impacts.
TEST(Windows, AreFewerWhereEachTakesMore) {
  Problem problem;
  problem.coordinates = {0};
  EXPECT_EQ(most_windows(problem, 12, 0.25), 40u);
  problem.coordinates = {};
  problem.free_bodies = {0};
  problem.scene.scene.rigid_bodies.resize(1);
  EXPECT_EQ(most_windows(problem, 12, 0.25), 16u);
  problem.scene.scene.rigid_bodies[0].collision.triangles.resize(1);
  EXPECT_EQ(most_windows(problem, 12, 0.25), 8u);
  EXPECT_EQ(most_windows(problem, 12, 2), 6u);
}

TEST(Workflow, SaysWhatItHadNoTimeToLookFor) {
  const TestFolder folder;
  Problem problem = make_problem(chain(folder, BOTH));
  Device device;
  Settings settings;
  Workflow hurried(device, problem, settings);
  EXPECT_TRUE(hurried.has_time("a pair of effects", 0));
  EXPECT_TRUE(hurried.left_out.empty());
  settings.minutes = 1;
  EXPECT_TRUE(hurried.has_time("a pair of effects", 30));
  EXPECT_FALSE(hurried.has_time("a pair of effects", 61));
  ASSERT_EQ(hurried.left_out.size(), 1u);
  EXPECT_EQ(hurried.left_out[0],
            "a pair of effects was not looked for: 0 s were over and it takes some 61 s more; `--minutes`, which is 1, "
            "gives it more");
}

// While this process waits, as on a machine that others use, a second of the processor takes longer by the clock.
TEST(Workflow, TellsHowLongWorkTakesOnABusyMachine) {
  const TestFolder folder;
  Problem problem = make_problem(chain(folder, BOTH));
  Device device;
  const Settings settings;
  const Workflow flow(device, problem, settings);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_GT(flow.by_the_clock(1), 2);
  EXPECT_DOUBLE_EQ(flow.by_the_clock(0), 0);
}

// Nothing can be compared in a tenth of a second; still there is a report, and it says so.
TEST(Workflow, ReportsAfterItsTimeWhateverIsLeftOut) {
  const TestFolder folder;
  Problem problem = make_problem(chain(folder, BOTH));
  Device device;
  Settings settings;
  settings.minutes = 1e-4;
  const Diagnosis found = diagnose(device, problem, settings, {});
  EXPECT_EQ(found.verdict, Verdict::none);
  EXPECT_FALSE(found.left_out.empty());
  EXPECT_LT(found.seconds, 10);
}

TEST(Candidates, OfAJointThatSlidesHaveUnitsOfForcesAndLengths) {
  const TestFolder folder;
  const Problem problem = make_problem(chain(folder, BOTH));
  std::map<std::string, std::string> units;
  std::map<std::string, double> prior_sigma;
  for (const Candidate& candidate : make_candidates(problem, {}))
    for (const Parameter& p : candidate.parameters) {
      units[candidate.label() + " " + p.name] = p.unit;
      prior_sigma[candidate.label() + " " + p.name] = p.prior_sigma;
    }
  EXPECT_EQ(units["joint_viscous_friction at hinge damping"], "N m s/rad");
  EXPECT_EQ(units["joint_viscous_friction at rail damping"], "N s/m");
  EXPECT_EQ(units["joint_spring at rail stiffness"], "N/m");
  EXPECT_EQ(units["joint_spring at rail preload"], "N");
  const RigidBody& slider = problem.scene.scene.rigid_bodies[std::size_t(problem.scene.scene.joints[1].child)];
  EXPECT_DOUBLE_EQ(prior_sigma["joint_spring at rail preload"], 9.81 * slider.mass);  // its weight
  EXPECT_EQ(prior_sigma["joint_spring at hinge preload"], 0);                         // nothing is known
  EXPECT_EQ(units["joint_stribeck_friction at rail stribeck_velocity"], "m/s");
}

TEST(Problem, WithoutAHeldOutRunTheReaderIsToldThatNothingWillBeNamed) {
  const TestFolder folder;
  const std::vector<std::string> sentences = warnings(make_problem(chain(folder, BOTH)));
  ASSERT_FALSE(sentences.empty());
  EXPECT_NE(sentences[0].find("no run is held out"), std::string::npos);
}

}  // namespace
}  // namespace pvg::diagnose
