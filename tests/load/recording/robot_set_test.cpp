// Recordings of robots from sets of episodes
#include "host/load/recording/robot_set.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/hdf5/file.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

using nlohmann::json;

const std::filesystem::path TASK = std::filesystem::path(PVG_DATA_FOLDER) / "tasks/weigh_beaker.yaml";
const std::vector<std::string> ARM = {"fr3_joint1", "fr3_joint2", "fr3_joint3", "fr3_joint4",
                                      "fr3_joint5", "fr3_joint6", "fr3_joint7"};

// Two episodes of 10 rows: joint k is at k + 0.1 f, and told to be at k + 0.1 (f + 1) + 0.01; the gripper's width is
// 0.08, told to be 0.06.
json table() {
  json columns;
  for (int episode = 0; episode < 2; ++episode)
    for (int f = 0; f < 10; ++f) {
      json state, action;
      for (int k = 0; k < 7; ++k) {
        state.push_back(k + 0.1 * f + episode);
        action.push_back(k + 0.1 * (f + 1) + 0.01 + episode);
      }
      state.push_back(0.08);
      action.push_back(0.06);
      columns["observation.state"].push_back(state);
      columns["action"].push_back(action);
      columns["episode_index"].push_back(episode);
      columns["frame_index"].push_back(f);
    }
  return columns;
}

std::vector<std::string> columns_of_arm() {
  std::vector<std::string> names = ARM;
  names.push_back("gripper_width");
  return names;
}

json info(const json& names) {
  const json feature = {{"dtype", "float32"}, {"names", names}};
  return {
      {"codebase_version", "v3.0"}, {"fps", 20}, {"features", {{"observation.state", feature}, {"action", feature}}}};
}

Recording lerobot(const TestFolder& folder, const json& said, const json& rows = table()) {
  std::filesystem::create_directories(folder.path / "meta");
  std::filesystem::create_directories(folder.path / "data/chunk-000");
  folder.write("meta/info.json", said.dump());
  folder.write("data/chunk-000/file-000.parquet", "");
  return load_robot_set(folder.path, TASK, [&](const auto& files, const auto&) {
    EXPECT_EQ(files.size(), 1u);
    return rows;
  });
}

TEST(RobotSet, OfLeRobotIsReadAsItIs) {
  const TestFolder folder;
  const Recording r = lerobot(folder, info(columns_of_arm()));
  ASSERT_EQ(r.runs.size(), 2u);
  EXPECT_FALSE(r.runs[0].is_held_out);
  EXPECT_TRUE(r.runs[1].is_held_out);
  ASSERT_EQ(r.channels.size(), 7u);
  EXPECT_EQ(r.channels[3].joint, "fr3_joint4");
  ASSERT_EQ(r.inputs.size(), 9u);  // and two fingers
  EXPECT_EQ(r.inputs[3].target, "joint/fr3_joint4/position");
  const MeasuredTable& rows = r.runs[0].table;
  EXPECT_DOUBLE_EQ(rows["t"][4], 0.2);
  EXPECT_DOUBLE_EQ(rows[r.channels[3].columns[0]][4], 3.4);
  EXPECT_DOUBLE_EQ(rows[r.inputs[3].columns[0]][4], 3.41);  // the action of the row before
  EXPECT_DOUBLE_EQ(rows[r.inputs[3].columns[0]][0], 3);     // nothing was told yet: where it stands
  EXPECT_DOUBLE_EQ(rows[r.inputs[8].columns[0]][4], 0.03);  // half the width
  EXPECT_EQ(std::stod(r.runs[1].initial.at("joint/fr3_joint4/position").value[0]), 4);
}

TEST(RobotSet, NamesMayBeThoseOfMotors) {
  const TestFolder folder;
  std::vector<std::string> names = columns_of_arm();
  names[2] += ".pos";
  EXPECT_EQ(lerobot(folder, info({{"motors", names}})).channels[2].joint, "fr3_joint3");
}

TEST(RobotSet, ThatDoesNotFitItsTaskIsRefused) {
  const TestFolder folder;
  const auto refused = [&](const json& said, std::initializer_list<const char*> words) {
    expect_error<UsageError>([&] { lerobot(folder, said); }, words);
  };
  std::vector<std::string> names = columns_of_arm();
  names[2] = "elbow";
  refused(info(names), {"no column of the joint `fr3_joint3`", "elbow", "weigh_beaker.yaml"});
  refused(info(nullptr), {"info.json", "names", "observation.state"});
  refused(info(ARM), {"rows of 8 numbers", "7"});
  json old = info(ARM);
  old["codebase_version"] = "v1.6";
  refused(old, {"info.json", "v1.6", "v2.1"});
  old["codebase_version"] = 3;
  refused(old, {"info.json", "`3`", "v2.1"});
  old = info(ARM);
  old.erase("fps");
  refused(old, {"info.json", "fps"});
  expect_error<UsageError>(
      [&] { load_robot_set(folder.path, std::filesystem::path(PVG_DATA_FOLDER) / "validation/pendulum.yaml", {}); },
      {"pendulum.yaml", "no task"});
}

// What pushed the targets away is what the drives followed.
void expect_targets_of_records(bool is_disturbed) {
  const TestFolder folder;
  const std::filesystem::path set = folder.path / "set";
  std::filesystem::create_directories(set / "episode_000000");
  hdf5::File file = hdf5::File::create(set / "episode_000000/states.h5");
  std::vector<std::string> joints = ARM;
  joints.push_back("left_slide");
  joints.push_back("right_slide");
  std::vector<double> time, q, a;
  for (int step = 0; step < 9; ++step) {
    time.push_back(0.02 * (step + 1));
    for (int j = 0; j < 9; ++j) q.push_back(j + 0.5 * step), a.push_back(j + 0.5 * step + 0.25);
  }
  file.write("/time", {9}, time);
  file.write("/q", {9, 9}, q);
  file.write("/a", {9, 9}, a);
  file.attribute("/q", "names", joints);
  if (is_disturbed) {
    std::vector<double> pushed(81, 0);
    pushed[3 * 9 + 6] = -0.5;
    file.write("/disturbance", {9, 9}, pushed);
  }
  file.close();
  EXPECT_TRUE(is_robot_set(set / "episode_000000"));
  const Recording r = load_robot_set(set, TASK, {});
  ASSERT_EQ(r.runs.size(), 1u);
  EXPECT_FALSE(r.runs[0].is_held_out);
  EXPECT_EQ(r.channels.size(), 9u);
  EXPECT_EQ(r.runs[0].table[r.channels[6].columns[0]][3], 7.5);
  EXPECT_EQ(r.runs[0].table[r.inputs[6].columns[0]][3], is_disturbed ? 7.25 : 7.75);
  EXPECT_EQ(r.runs[0].table[r.inputs[6].columns[0]][4], 8.25);
}

TEST(RobotSet, OfOurOwnRecordsHasTheirTargets) { expect_targets_of_records(false); }

TEST(RobotSet, OfDisturbedRecordsHasWhatTheDrivesFollowed) { expect_targets_of_records(true); }

// An arm on record at rest, then 20 steps of 25 ms in which it lags 0.01 behind its targets; as `pack` writes it, a row
// of the start and one per two steps. What diagnose gets of both is the same at the same times, and the packed set adds
// where the arm started.
TEST(RobotSet, OfPackedRowsFromTheStartOnAgreesWithItsRecord) {
  const TestFolder folder;
  const auto target = [](int step, int joint) { return joint + 0.1 * (step + 1); };
  std::vector<std::string> joints = ARM;
  joints.insert(joints.end(), {"left_slide", "right_slide"});
  std::vector<double> time, q, a;
  for (int step = 0; step < 20; ++step) {
    time.push_back(0.025 * (step + 1));
    for (int j = 0; j < 9; ++j) {
      a.push_back(j < 7 ? target(step, j) : 0.04);
      q.push_back(j < 7 ? target(step, j) - 0.01 : 0.04);
    }
  }
  std::filesystem::create_directories(folder.path / "episode_000000");
  hdf5::File file = hdf5::File::create(folder.path / "episode_000000/states.h5");
  file.write("/time", {20}, time);
  file.write("/q", {20, 9}, q);
  file.write("/a", {20, 9}, a);
  file.attribute("/q", "names", joints);
  file.close();
  json packed;
  for (int f = 0; f <= 10; ++f) {
    json state, action;
    for (int j = 0; j < 7; ++j) {
      state.push_back(f == 0 ? j : target(2 * f - 1, j) - 0.01);
      action.push_back(target(std::min(2 * f + 1, 19), j));
    }
    state.push_back(0.08);
    action.push_back(0.08);
    packed["observation.state"].push_back(state);
    packed["action"].push_back(action);
    packed["episode_index"].push_back(0);
    packed["frame_index"].push_back(f);
  }
  const Recording record = load_robot_set(folder.path / "episode_000000", TASK, {});
  const TestFolder set;
  const Recording rows = lerobot(set, info(columns_of_arm()), packed);
  const MeasuredTable &fine = record.runs.at(0).table, &coarse = rows.runs.at(0).table;
  for (std::size_t j = 0; j < 7; ++j) {
    const std::string state = "state " + joints[j], told = "target " + joints[j];
    for (std::size_t f = 1; f <= 10; ++f) {
      ASSERT_NEAR(coarse["t"][f], fine["t"][2 * f - 1], 1e-12);
      EXPECT_NEAR(coarse[state][f], fine[state][2 * f - 1], 1e-12) << joints[j] << ", row " << f;
      EXPECT_NEAR(coarse[told][f], fine[told][2 * f - 1], 1e-12) << joints[j] << ", row " << f;
    }
    EXPECT_EQ(coarse["t"][0], 0);
    EXPECT_EQ(coarse[told][0], double(j));
    EXPECT_EQ(std::stod(rows.runs[0].initial.at("joint/" + joints[j] + "/position").value[0]), double(j));
  }
}

TEST(RobotsAlone, AreAnArmAndItsGripperThatNothingTouches) {
  const SceneRun run = load_robots_alone(TASK);
  EXPECT_TRUE(run.scene.soft_bodies.empty());
  EXPECT_TRUE(run.scene.cloths.empty());
  EXPECT_EQ(run.targets.size(), 9u);
  for (const RigidBody& body : run.scene.rigid_bodies) EXPECT_NE(body.name, "beaker");
}

}  // namespace
}  // namespace pvg
