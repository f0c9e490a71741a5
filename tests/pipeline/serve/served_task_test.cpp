// A served task is the task of `generate`: the same targets give the same bits. And a hand that stays away fails.
#include "pipeline/serve/served_task.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include "host/dataset/packed_episode.hpp"
#include "host/dataset/states_record.hpp"
#include "host/formats/video.hpp"
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
  explicit Demonstration(const Task& task, Device& device, bool renders = false) {
    const std::atomic<bool> stop = false;
    EpisodeDevices devices(device, device);
    EpisodeSettings settings;
    settings.seed = SEED;
    settings.episode = EPISODE;
    settings.renders = renders;
    report = run_episode(task, settings, devices, folder.path, stop, [](auto, auto) {});
    folder.write("summary.json", summary_json(task, settings, report));
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

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0 : INFINITY;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// Row 0 is what reset() shows, and the action of each row leads to the next one. Targets go on straight lines within a
// period, those of the demonstration do not, which the joints show at the ends of periods by little. Replayed from the
// start, rows that begin one period after it are a period ahead.
TEST_F(Served, ActionsOfAPackedEpisodeLeadFromEachRowToTheNext) {
  const Demonstration demonstration(small_task(), device());
  ServedTask served(small_task(), device(), nullptr);
  const PackedEpisode packed = read_packed_states(demonstration.folder.path, true);
  const auto replay = [&](const Rows& actions) {
    served.reset(SEED, EPISODE);
    double off = 0;
    for (std::size_t row = 0; row + 1 < packed.n_frames(); ++row) {
      served.act(actions[row]);
      off = std::max(off, largest_difference(served.joints(), packed.state[row + 1]));
    }
    return off;
  };
  ASSERT_EQ(packed.n_frames(), demonstration.report.n_frames + 1);
  served.reset(SEED, EPISODE);
  EXPECT_EQ(packed.state[0], served.joints());
  EXPECT_EQ(packed.environment[0], served.environment());
  EXPECT_LE(replay(packed.action), 2e-4);  // [rad]
  EXPECT_EQ(served.failure(), std::nullopt);
  EXPECT_GE(replay(read_packed_states(demonstration.folder.path, false).action), 1e-2);
}

TEST_F(Served, ThePictureOfTheStartIsThatOfAReset) {
  Task task = small_task();
  task.motion.resize(1);
  const Demonstration demonstration(task, device(), true);
  ServedTask served(task, device(), &device());
  served.reset(SEED, EPISODE);
  const auto bytes_of = [](const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  for (std::size_t i = 0; i < task.cameras.size(); ++i) {
    const Picture8 picture = served.picture(i);
    const std::filesystem::path encoded = demonstration.folder.path / "encoded.mp4";
    VideoWriter video(encoded, picture.width, picture.height, task.render.frames_per_second);
    video.write(picture.rgb);
    video.finish();
    EXPECT_GT(bytes_of(encoded).size(), 500u);
    EXPECT_TRUE(bytes_of(encoded) == bytes_of(start_video(demonstration.folder.path, task.cameras[i].name))) << i;
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

// everything that is simulated, to the bit
std::vector<unsigned char> state_bytes(const ServedTask& served) {
  Message message;
  add_state_arrays(served, message);
  return message.bytes;
}

// Three worlds that begin, end and step at different times, with other actions, against each of them alone.
TEST_F(Served, WorldsThatStepTogetherHaveTheBitsTheyHaveAlone) {
  constexpr std::size_t N = 3, N_PERIODS = 4;
  const auto begin = [](ServedTask& served, std::size_t world, std::size_t period) {
    if (period == 0) served.ask_reset(SEED, world);
    if (period == 2 && world == 1) served.ask_reset(SEED + 1, 8);
  };
  const auto ask = [](ServedTask& served, std::size_t world, std::size_t period) {
    if (world == 2 && period == 1) return;  // rests
    if (world == 2 && period == 3) return served.ask_targets({served.targets(), served.targets()});
    if (world == 0) return void(served.ask_plan());
    std::vector<double> action = served.joints();
    action[0] += 0.01 * double(world);
    action[1] += 0.02;
    served.ask_action(action);
  };
  ServedWorlds worlds(small_task(), device(), nullptr, N);
  std::vector<ServedTask*> all;
  for (std::size_t w = 0; w < N; ++w) all.push_back(&worlds[w]);
  std::vector<std::vector<std::vector<unsigned char>>> together(N_PERIODS);
  for (std::size_t period = 0; period < N_PERIODS; ++period) {
    for (std::size_t w = 0; w < N; ++w) begin(worlds[w], w, period);
    ServedTask::advance_together(all);
    for (std::size_t w = 0; w < N; ++w) ask(worlds[w], w, period);
    ServedTask::advance_together(all);
    for (std::size_t w = 0; w < N; ++w) together[period].push_back(state_bytes(worlds[w]));
  }
  for (std::size_t w = 0; w < N; ++w) {
    ServedTask alone(small_task(), device(), nullptr);
    ServedTask* const only = &alone;
    for (std::size_t period = 0; period < N_PERIODS; ++period) {
      begin(alone, w, period);
      ServedTask::advance_together(std::span(&only, 1));
      ask(alone, w, period);
      ServedTask::advance_together(std::span(&only, 1));
      EXPECT_TRUE(state_bytes(alone) == together[period][w]) << "world " << w << ", period " << period;
    }
  }
  EXPECT_EQ(worlds[2].n_steps(), 12u);
  EXPECT_FALSE(together[3][0] == together[3][2]);
}

// Of several that are to begin, one cannot: the others do.
TEST_F(Served, AStartThatIntersectsIsTheErrorOfItsWorldAlone) {
  Task task = small_task();
  ASSERT_EQ(task.objects.at(1).name, "beaker");
  task.objects[1].pose.z = {-0.002, 0.002};  // of the table's top
  ServedWorlds worlds(task, device(), nullptr, 2);
  const auto height = [&](std::uint64_t episode) {
    const TaskScene built = build_scene(task, SEED, episode);
    for (const RigidBody& body : built.scene.rigid_bodies)
      if (body.name == "beaker") return body.pose.translation().z();
    throw Failure("no beaker");
  };
  std::uint64_t in_table = 0, above = 0;
  while (height(in_table) > -1e-4) ++in_table;
  while (height(above) < 1e-3) ++above;
  worlds[0].ask_reset(SEED, in_table);
  worlds[1].ask_reset(SEED, above);
  ServedTask* const both[] = {&worlds[0], &worlds[1]};
  const std::vector<std::string> errors = ServedTask::advance_together(both);
  EXPECT_NE(errors[0].find("intersect"), std::string::npos) << errors[0];
  EXPECT_EQ(errors[1], "");
  expect_error<UsageError>([&] { worlds[0].act(worlds[1].joints()); }, {"no episode has begun"});
  worlds[1].act(worlds[1].joints());
  EXPECT_EQ(worlds[1].n_steps(), 5u);
}

TEST_F(Served, SurfacesThatMeetAreNamed) {
  ServedTask served(small_task(), device(), nullptr);
  served.reset(SEED, EPISODE);
  EXPECT_EQ(served.intersection(), "");
  WorldState pushed_in = served.state();
  const Scene& scene = served.built().scene;
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i)
    if (scene.rigid_bodies[i].name == "beaker") pushed_in.rigid[i](2, 3) -= 0.01;
  const std::string meeting = Surfaces(scene).meeting(pushed_in);
  EXPECT_TRUE(meeting == "beaker and table" || meeting == "table and beaker") << meeting;
}

TEST_F(Served, AnActionBeyondAStopIsAnEvent) {
  ServedTask served(small_task(), device(), nullptr);
  served.reset(0, 0);
  std::vector<double> action = served.joints();
  action[7] = -0.004;  // a gripper that presses
  served.act(action);
  for (const EpisodeEvent& event : served.events()) EXPECT_NE(event.name, "out_of_reach");
  ASSERT_TRUE(std::isfinite(served.facts().columns[0].high));
  action[0] = served.facts().columns[0].high + 0.001;
  served.act(action);
  const auto is_it = [&](const EpisodeEvent& event) {
    return event.name == "out_of_reach" && event.of == served.facts().columns[0].packed.name;
  };
  EXPECT_EQ(std::count_if(served.events().begin(), served.events().end(), is_it), 1);
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
  expect_error<UsageError>([&] { served.follow({std::vector<double>(9, 0.0), {}}); }, {"9 joints with a drive", "0"});
  expect_error<UsageError>([&] { served.picture(0); }, {"--no-render"});
  EXPECT_EQ(served.environment(), before);
  EXPECT_EQ(served.n_steps(), 0u);
  EXPECT_GT(served.n_planned_periods(), 0u);  // to be asked how many there are begins nothing
  served.act(served.joints());
  expect_error<UsageError>([&] { served.follow_plan(); }, {"begins where an episode begins"});
}

// One of two pictures is not there: half of the episodes cannot be built.
TEST_F(Served, AnEpisodeThatCannotBeBuiltLeavesTheOneUnderWay) {
  Task task = small_task();
  Variation texture{Variation::Quantity::texture, "clay", {}};
  texture.files = {"/nowhere.png", PVG_DATA_FOLDER "/cloths/terry.png"};
  task.variations = {texture};
  std::uint64_t good = 0, bad = 0;
  while (uniform_number(0, good, "clay/texture") < 0.5) ++good;
  while (uniform_number(0, bad, "clay/texture") >= 0.5) ++bad;
  ServedTask served(task, device(), nullptr);
  served.reset(0, good);
  served.act(served.joints());
  const std::vector<double> before = served.environment();
  expect_error<UsageError>([&] { served.reset(0, bad); }, {"/nowhere.png"});
  EXPECT_EQ(served.environment(), before);
  EXPECT_EQ(served.n_steps(), served.facts().steps_per_period);
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
