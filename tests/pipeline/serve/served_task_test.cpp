// A served task is the task of `generate`: the same targets give the same bits. And a hand that stays away fails.
#include "pipeline/serve/served_task.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>

#include "host/dataset/states_record.hpp"
#include "host/load/task_file.hpp"
#include "host/render/renderer.hpp"
#include "pipeline/episode/episode.hpp"
#include "pipeline/serve/perturbation.hpp"
#include "pipeline/serve/state_arrays.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

constexpr std::uint64_t SEED = 7, EPISODE = 3;

Task small_task() { return load_task(PVG_DATA_FOLDER "/../tests/pipeline/small_task/push_beaker.yaml"); }

// An episode of `generate`, on record.
struct Demonstration {
  explicit Demonstration(const Task& task, Device& device) {
    const std::atomic<bool> stop = false;
    EpisodeDevices devices(device, device);
    EpisodeSettings settings;
    settings.seed = SEED;
    settings.episode = EPISODE;
    settings.renders = false;
    report = run_episode(task, settings, devices, folder.path, stop, [](auto, auto) {});
    record = std::make_unique<StatesRecord>(folder.path / "states.h5");
    a = record->series("/a");
    T_rigid = record->poses("/T_rigid");
  }
  std::vector<double> target(std::size_t step) const {
    const std::size_t n = a.names.size();
    return {a.values.begin() + std::ptrdiff_t(step * n), a.values.begin() + std::ptrdiff_t((step + 1) * n)};
  }

  TestFolder folder;
  EpisodeReport report;
  std::unique_ptr<StatesRecord> record;
  StatesRecord::Series a;
  std::vector<double> T_rigid;  // [T, R, 3, 4]
};

std::vector<double> array_of(const Message& message, const std::string& name) {
  for (const auto& array : message.head["arrays"]) {
    if (array["name"] != name) continue;
    std::size_t n = 1;
    for (const std::size_t size : array["shape"]) n *= size;
    std::vector<double> values(n);
    std::memcpy(values.data(), message.bytes.data() + array["offset"].get<std::size_t>(), n * sizeof(double));
    return values;
  }
  return {};
}

// q, poses and nodes of the state against a step of the record, to the bit
void expect_bits(const ServedTask& served, const Demonstration& demonstration, std::size_t step) {
  Message message;
  add_state_arrays(served, message);
  const auto row = [&](const std::vector<double>& all, std::size_t width) {
    return std::vector<double>(all.begin() + std::ptrdiff_t(step * width),
                               all.begin() + std::ptrdiff_t((step + 1) * width));
  };
  const std::vector<double> q = array_of(message, "q"), T_rigid = array_of(message, "T_rigid");
  ASSERT_EQ(q.size(), demonstration.a.names.size());
  ASSERT_EQ(T_rigid.size(), 24u);
  EXPECT_EQ(q, row(demonstration.record->series("/q").values, q.size())) << "step " << step;
  EXPECT_EQ(T_rigid, row(demonstration.T_rigid, T_rigid.size())) << "step " << step;
}

struct Served : testing::Test {
  static Device& device() {
    static Device shared;
    return shared;
  }
};

TEST_F(Served, AReplayedDemonstrationHasTheDemonstrationsBits) {
  const Demonstration demonstration(small_task(), device());
  ASSERT_TRUE(demonstration.report.has_succeeded) << demonstration.report.reason;
  ServedTask served(small_task(), device(), nullptr);
  const std::size_t n_steps = demonstration.record->n_steps(), period = served.facts().steps_per_period;
  ASSERT_EQ(period, 5u);
  served.reset(SEED + 1, 0);  // what was before must not show
  ASSERT_TRUE(served.follow_plan());
  for (const bool follows_plan : {false, true}) {
    served.reset(SEED, EPISODE);
    for (std::size_t first = 0; first < n_steps; first += period) {
      std::vector<std::vector<double>> rows;
      for (std::size_t i = 0; i < period; ++i) rows.push_back(demonstration.target(first + i));
      if (follows_plan)
        ASSERT_TRUE(served.follow_plan());
      else
        served.follow(rows);
      expect_bits(served, demonstration, first + period - 1);
    }
    EXPECT_EQ(served.failure(), std::nullopt);
  }
  EXPECT_FALSE(served.follow_plan());
}

TEST_F(Served, PackedActionsOfEveryStepGiveTheSameBits) {
  Task task = small_task();
  task.render.frames_per_second = 50;
  const Demonstration demonstration(task, device());
  ServedTask served(task, device(), nullptr);
  ASSERT_EQ(served.facts().steps_per_period, 1u);
  ASSERT_EQ(served.facts().columns.size(), 8u);
  EXPECT_EQ(served.facts().columns[7].packed.name, "gripper_width");
  served.reset(SEED, EPISODE);
  for (std::size_t step = 0; step < 10; ++step) {
    const std::vector<double> target = demonstration.target(step);
    std::vector<double> action(target.begin(), target.begin() + 7);
    action.push_back(target[7] + target[8]);
    served.act(action);
    expect_bits(served, demonstration, step);
  }
}

TEST_F(Served, AnActionIsReachedOnAStraightLine) {
  ServedTask served(small_task(), device(), nullptr);
  served.reset(0, 0);
  std::vector<double> action = served.joints();
  const double start = action[0];
  action[0] += 0.01;
  served.act(action);
  EXPECT_EQ(served.targets()[0], action[0]);
  EXPECT_NEAR(served.joints()[0], start + 0.01, 1e-3);  // drives follow at once
  EXPECT_EQ(served.n_steps(), 5u);
}

// Drives that are late by a period do nothing in the first and all of it in the second.
TEST_F(Served, APerturbedLatencyHoldsActionsBack) {
  Task task = small_task();
  perturb(task, read_perturbation("latency=0.1"));
  ServedTask served(task, device(), nullptr);
  served.reset(0, 0);
  std::vector<double> action = served.joints();
  const double start = action[0];
  action[0] += 0.01;
  served.act(action);
  EXPECT_NEAR(served.joints()[0], start, 1e-4);
  served.act(action);
  EXPECT_NEAR(served.joints()[0], start + 0.01, 1e-3);
}

TEST_F(Served, AHandThatStaysAwayFails) {
  ServedTask served(small_task(), device(), nullptr);
  for (const std::uint64_t episode : {0u, 1u, 2u}) {
    served.reset(SEED, episode);
    const std::vector<double> stay = served.joints();
    for (int period = 0; period < 5; ++period) served.act(stay);
    EXPECT_NE(served.failure().value_or("").find("position error"), std::string::npos);
  }
}

// the policy sees what the demonstrations' videos show
TEST_F(Served, PicturesAreFilteredWhereTheTaskSaysSo) {
  setenv("PVG_DENOISER", "none", 1);  // the built-in filter
  Task task = small_task();
  task.render.samples = 2;
  const auto shown = [&](bool denoise) {
    task.render.denoise = denoise;
    ServedTask served(task, device(), &device());
    served.reset(SEED, EPISODE);
    return served.picture(0);
  };
  EXPECT_NE(shown(true).rgb, shown(false).rgb);
  unsetenv("PVG_DENOISER");
}

// A cloth of 3 x 3 points that falls beside the push.
TEST_F(Served, KeypointsOfAClothFollowItsObjects) {
  Task task = small_task();
  ClothSection& section = task.cloths.emplace_back();
  section.cloth.name = "towel";
  for (int point = 0; point < 9; ++point)
    section.cloth.mesh.points.emplace_back(0.02 * (point % 3), 0.02 * (point / 3), 0);
  for (std::uint32_t corner : {0u, 1u, 3u, 4u}) {
    section.cloth.mesh.triangles.push_back({corner, corner + 1, corner + 4});
    section.cloth.mesh.triangles.push_back({corner, corner + 4, corner + 3});
  }
  section.pose.x = {0.4, 0.4};
  section.pose.y = {0.3, 0.3};
  section.pose.z = {0.2, 0.2};
  ServedTask served(task, device(), nullptr);
  served.reset(SEED, EPISODE);
  const std::size_t first = 7 * served.facts().objects.size();
  ASSERT_EQ(served.environment().size(), first + 24);
  served.act(served.joints());
  const std::vector<Vec3>& points = served.state().cloth.at(0);
  const std::vector<double> environment = served.environment();
  const std::array<std::size_t, 8> around = {0, 1, 2, 5, 8, 7, 6, 3};
  for (std::size_t k = 0; k < around.size(); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(environment[first + 3 * k + axis], points[around[k]][Eigen::Index(axis)]) << k;
  EXPECT_LT(points[0].z(), 0.18);  // it has fallen for 0.1 s
}

TEST_F(Served, WhatCannotBeDoneIsRefusedAndChangesNothing) {
  ServedTask served(small_task(), device(), nullptr);
  expect_error<UsageError>([&] { served.act(std::vector<double>(8, 0.0)); }, {"no episode", "reset"});
  served.reset(0, 0);
  const std::vector<double> before = served.environment();
  expect_error<UsageError>([&] { served.act(std::vector<double>(7, 0.0)); }, {"8 numbers", "7"});
  expect_error<UsageError>([&] { served.act(std::vector<double>(8, std::nan(""))); }, {"finite"});
  expect_error<UsageError>([&] { served.follow({std::vector<double>(9, 0.0), {}}); }, {"9 numbers", "0"});
  expect_error<UsageError>([&] { served.picture(0); }, {"--no-render"});
  EXPECT_EQ(served.environment(), before);
  EXPECT_EQ(served.n_steps(), 0u);
  served.act(served.joints());
  expect_error<UsageError>([&] { served.follow_plan(); }, {"begins where an episode begins"});
}

// An arm that is told to be elsewhere at once: no step can follow.
TEST_F(Served, AStepThatCannotBeDoneEndsTheEpisodeWithItsReason) {
  Task task = small_task();
  task.solver.max_newton = 1;
  task.solver.max_step_halvings = 0;
  ServedTask served(task, device(), nullptr);
  served.reset(0, 0);
  std::vector<double> action = served.joints();
  action[1] += 1.5;
  served.act(action);
  ASSERT_TRUE(served.is_over());
  EXPECT_EQ(served.failure(), served.reason());
  expect_error<UsageError>([&] { served.act(action); }, {"over", "reset"});
  served.reset(0, 0);
  EXPECT_FALSE(served.is_over());
}

TEST(Tasks, TheStartOfEveryTaskIsNoSuccess) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files = {PVG_DATA_FOLDER "/../scripts/policy/push_beaker.yaml",
                                 PVG_DATA_FOLDER "/../scripts/policy/fold_towel.yaml"};
  for (const auto& entry : fs::directory_iterator(PVG_DATA_FOLDER "/tasks")) files.push_back(entry.path());
  for (const fs::path& file : files) {
    const Task task = load_task(file);
    const TaskScene built = build_scene_at_middle(task);
    WorldState start;
    static_cast<SceneState&>(start) = initial_state(built.scene);
    for (const Joint& joint : built.scene.joints) start.joint_position.push_back(joint.initial);
    SuccessMonitor monitor(task, built.scene, hands_of(built), start);
    const std::vector<Phase> phase(built.robots.size(), Phase::free);
    monitor.observe(start, phase);
    EXPECT_TRUE(monitor.failure().has_value()) << file;
  }
}

}  // namespace
}  // namespace pvg
