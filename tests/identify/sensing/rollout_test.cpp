// Windows simulated by several processes at once
#include "host/identify/sensing/rollout.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "host/base/error.hpp"
#include "host/identify/sensing/forked.hpp"
#include "host/identify/sensing/known_predictions.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// A block that falls on a floor, as a scene has it.
Problem thrown_block(const TestFolder& folder) {
  folder.write("scene.yaml", R"(schema: 1
name: thrown_block
time_step: 5 ms
contact: {activation_distance: 1 mm, stiffness: 1 MPa}
bodies:
  - {name: floor, kind: half_space, normal: [0, 0, 1]}
  - {name: block, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.04]}}, mass: 0.4, pose: {position: [0, 0, 0.05]}}
)");
  std::string run = "t,x,y,z\n";
  for (int i = 0; i < 30; ++i) run += std::to_string(0.01 * i) + "," + std::to_string(0.01 * i) + ",0,0.05\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {columns: [x, y, z], kind: position, body: block, unit: m, noise: 0.0005}
)");
  return make_problem(folder.path / "recording.yaml");
}

// One result for each of `n` strengths of gravity.
std::vector<Prediction> predict(Device& device, const Problem& problem, int n, std::size_t n_processes) {
  Predictor predictor(device, problem, n_processes);
  std::vector<Variant> variants;
  for (int i = 0; i < n; ++i) {
    variants.push_back({problem.scene.scene, {}});
    variants.back().scene.gravity *= 1 + 0.1 * i;
  }
  const std::vector<Window> windows = make_windows(problem, false, 0, 1);
  std::vector<Job> jobs;
  for (const Variant& variant : variants) jobs.push_back({&variant, &windows.at(0), windows[0].initial, true});
  return predictor.predict(jobs);
}

TEST(Rollout, SeveralProcessesFindTheSameBitsAsOne) {
  const TestFolder folder;
  const Problem problem = thrown_block(folder);
  setenv("POCL_DEVICES", "basic", 1);
  Device device;
  // a process that has used another of PoCL's devices before keeps it; ctest runs each test in one of its own
  if (!device.info().name.starts_with("basic")) GTEST_SKIP() << "needs POCL_DEVICES=basic, not " << device.info().name;
  for (const int n : {1, 2, 7}) {
    const std::vector<Prediction> one = predict(device, problem, n, 1), three = predict(device, problem, n, 3);
    ASSERT_EQ(one.size(), std::size_t(n));
    ASSERT_EQ(three.size(), std::size_t(n));
    for (std::size_t i = 0; i < std::size_t(n); ++i) {
      EXPECT_TRUE(one[i].succeeded && three[i].succeeded);
      EXPECT_EQ(one[i].residual, three[i].residual) << i << " of " << n;
      EXPECT_EQ(one[i].phase, three[i].phase);
      EXPECT_EQ(one[i].touching, three[i].touching);
    }
    EXPECT_EQ(one[0].touching.size(), 1u);
    if (n > 1) {
      EXPECT_NE(one[0].residual, one[1].residual);
    }
  }
}

// It is recorded as flying along x with 1 m/s; a channel that is late by 20 ms shows it 20 mm behind, 40 times the
// noise, from the first sample on.
TEST(Rollout, ALateChannelSawWhatMovedBeforeTheStart) {
  const TestFolder folder;
  const Problem problem = thrown_block(folder);
  Device device;
  Predictor predictor(device, problem);
  Variant late{problem.scene.scene, {}};
  late.scene.gravity.setZero();
  late.sensing.latency = {0.02};
  const Window window = make_windows(problem, false, 0, 1).at(0);
  const Job job{&late, &window, window.initial};
  const Prediction prediction = predictor.predict({&job, 1}).at(0);
  for (std::size_t i = 0; i < window.data.size(); ++i)
    EXPECT_NEAR(prediction.residual[Eigen::Index(i)], window.data[i].component == 0 ? 40 : 0, 0.1) << i;
}

// Errors of a sensor move nothing: what they are tried in is simulated once, and each sees what it would see alone.
TEST(Rollout, WhatDiffersInTheSensingAloneIsSimulatedOnce) {
  const TestFolder folder;
  const Problem problem = thrown_block(folder);
  Device device;
  const Window window = make_windows(problem, false, 0, 1).at(0);
  std::vector<Variant> variants(4, {problem.scene.scene, {}});
  variants[1].sensing.latency = {0.02};
  variants[2].sensing.clock_offset = 0.03;  // needs more steps than the others
  variants[3].scene.gravity *= 2;
  std::vector<Job> jobs;
  for (const Variant& variant : variants) jobs.push_back({&variant, &window, window.initial, &variant == &variants[1]});
  Predictor together(device, problem);
  const std::vector<Prediction> found = together.predict(jobs);
  EXPECT_EQ(together.n_simulations(), 2u);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    Predictor alone(device, problem);
    const Prediction expected = alone.predict({&jobs[i], 1}).at(0);
    EXPECT_TRUE(expected.succeeded && found[i].succeeded);
    EXPECT_EQ(found[i].residual, expected.residual) << i;
    EXPECT_EQ(found[i].phase, expected.phase) << i;
    EXPECT_EQ(found[i].touching, expected.touching) << i;
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(found[i].residual, found[k].residual) << i << " as " << k;
  }
}

// A world holds the known pushes of its own window: one that is shared with a shorter window would lack the later ones.
TEST(Rollout, AShorterWindowHasAWorldOfItsOwn) {
  const TestFolder folder;
  Problem problem = thrown_block(folder);
  std::vector<double> force(effect_kind("push").parameters.size(), 0.0);
  force[2] = 20;  // along x [N]
  problem.runs[0].pushes = {{0.2, 0.25, Effect{"push", "block", force}}};
  Device device;
  const Variant variant{problem.scene.scene, {}};
  const Window whole = make_windows(problem, false, 0, 1).at(0);
  Window shorter = whole;
  shorter.end = whole.start + 0.05;
  std::erase_if(shorter.data, [&](const Datum& datum) { return problem.runs[0].t[datum.sample] > shorter.end; });
  ASSERT_LT(shorter.data.size(), whole.data.size());
  const std::vector<Job> jobs = {{&variant, &shorter, shorter.initial}, {&variant, &whole, whole.initial}};
  Predictor together(device, problem), alone(device, problem);
  const Eigen::VectorXd found = together.predict(jobs).at(1).residual;
  EXPECT_EQ(found, alone.predict({&jobs[1], 1}).at(0).residual);
  problem.runs[0].pushes.clear();
  Predictor without(device, problem);
  EXPECT_NE(found, without.predict({&jobs[1], 1}).at(0).residual);
}

TEST(Rollout, WhatIsAskedAgainIsNotSimulatedAgain) {
  const TestFolder folder;
  Problem problem = thrown_block(folder);
  Device device;
  Predictor predictor(device, problem);
  const Variant variant{problem.scene.scene, {}};
  Window window = make_windows(problem, false, 0, 1).at(0);
  Job job{&variant, &window, window.initial, false};
  const auto ask = [&] { return predictor.predict({&job, 1}).at(0).residual; };
  const Eigen::VectorXd first = ask();
  EXPECT_EQ(ask(), first);
  EXPECT_EQ(predictor.n_simulations(), 1u);
  job.initial.velocity[std::size_t(problem.channels[0].rigid)].x() += 0.1;
  EXPECT_NE(ask(), first);
  problem.channels[0].sigma *= 2;  // another noise, the same motion
  job.initial = window.initial;
  EXPECT_TRUE(ask().isApprox(first / 2));
  window.correction = Eigen::VectorXd::Constant(first.size(), 1);
  EXPECT_TRUE(ask().isApprox((first / 2).array().matrix() + window.correction));
  EXPECT_EQ(predictor.n_simulations(), 4u);
  job.wants_phases = true;
  EXPECT_EQ(predictor.predict({&job, 1}).at(0).phase.size(), window.data.size());
}

TEST(KnownPredictions, TheOldestAreForgottenFirst) {
  const auto add = [](KnownPredictions& known, std::uint64_t question, std::size_t n_numbers) {
    const Question asked{0, question};
    Prediction prediction;
    prediction.residual = Eigen::VectorXd::Constant(Eigen::Index(n_numbers), double(question));
    known.add({&asked, 1}, {prediction});
  };
  KnownPredictions known;
  constexpr std::size_t THIRD = KnownPredictions::MOST_NUMBERS / 3;
  for (const std::uint64_t question : {1, 2, 2, 3}) add(known, question, THIRD);
  EXPECT_EQ(known.n_numbers(), 3 * THIRD);
  add(known, 4, THIRD);
  EXPECT_EQ(known.find(1), nullptr);
  for (const std::uint64_t question : {2, 3, 4}) {
    ASSERT_NE(known.find(question), nullptr) << question;
    EXPECT_EQ(known.find(question)->residual[0], double(question));
  }
}

TEST(Forked, BytesComeBackAndSoDoesAReason) {
  Forked large([] { return std::vector<char>(1 << 20, 'x'); });
  Forked failing([]() -> std::vector<char> { throw Failure("the reason"); });
  Forked ended([]() -> std::vector<char> { std::raise(SIGKILL), std::abort(); });
  const Forked forgotten([] {
    std::this_thread::sleep_for(std::chrono::hours(1));
    return std::vector<char>();
  });
  EXPECT_EQ(large.result(), std::vector<char>(1 << 20, 'x'));
  const auto reason_of = [](Forked& process) {
    try {
      process.result();
    } catch (const Failure& failure) {
      return std::string(failure.what());
    }
    return std::string();
  };
  EXPECT_EQ(reason_of(failing), "the reason");
  EXPECT_NE(reason_of(ended).find("ended by signal 9"), std::string::npos);
}

}  // namespace
}  // namespace pvg::diagnose
