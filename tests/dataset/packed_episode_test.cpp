// What a data set's row holds, from an episode whose numbers are known (small_episode.hpp).
#include "host/dataset/packed_episode.hpp"

#include <array>
#include <cmath>

#include "host/base/error.hpp"
#include "host/dataset/packed_columns.hpp"
#include "tests/dataset/small_episode.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

TEST(PackedEpisode, ARowIsWhatThePictureShowsAndTheTargetOfTheNextPicture) {
  const TestFolder root;
  const PackedEpisode episode = read_packed_episode(write_small_episode(root, "a", 4), {});
  EXPECT_EQ(episode.number, 4u);
  EXPECT_EQ(episode.task, "lift_cup");
  EXPECT_EQ(episode.robot, "arm");
  EXPECT_EQ(episode.columns, (std::vector<std::string>{"joint1", "gripper_width"}));
  EXPECT_EQ(episode.is_width, (std::vector<bool>{false, true}));
  // pictures are taken at the ends of steps 1, 3 and 5
  EXPECT_EQ(episode.state, (Rows{{2, 0.04}, {4, 0.08}, {6, 0.12}}));
  EXPECT_EQ(episode.action, (Rows{{40, 0.16}, {60, 0.24}, {60, 0.24}}));
  for (const std::vector<double>& velocity : episode.velocity) {
    EXPECT_NEAR(velocity[0], 10, 1e-12);  // 1 rad in 0.1 s
    EXPECT_NEAR(velocity[1], 0.2, 1e-12);
  }
  ASSERT_EQ(episode.tools.size(), 1u);
  EXPECT_LT((episode.tools[0].pose[1].col(3) - Eigen::Vector4d(4, 0.5, 0, 1)).norm(), 1e-12);
  EXPECT_EQ(episode.tools[0].width_action, (std::vector<double>{0.16, 0.24, 0.24}));
  ASSERT_EQ(episode.objects.size(), 1u);
  EXPECT_EQ(episode.objects[0].pose[2](1, 3), 6);
  ASSERT_EQ(episode.cameras.size(), 1u);
  EXPECT_TRUE(episode.cameras[0].moves);
  EXPECT_EQ(episode.cameras[0].K[0][0], 300);
  EXPECT_EQ(episode.cameras[0].T_world_camera[2][3], 6);
}

TEST(PackedEpisode, AnArmOfSeveralHasItsNameInItsColumns) {
  const TestFolder root;
  const PackedEpisode episode = read_packed_episode(write_small_episode(root, "a", 0, 3, "left/"), {});
  EXPECT_EQ(episode.columns, (std::vector<std::string>{"left_joint1", "left_gripper_width"}));
  EXPECT_EQ(episode.tools.at(0).name, "left_hand");
}

TEST(PackedEpisode, PosesOfObjectsAreNumbersOfTheEnvironment) {
  const TestFolder root;
  const PackedEpisode episode = read_packed_episode(write_small_episode(root, "a", 0), {});
  ASSERT_EQ(episode.environment_columns.size(), 7u);
  EXPECT_EQ(episode.environment_columns.front().name, "cup_x");
  EXPECT_EQ(episode.environment_columns.back().name, "cup_qw");
  ASSERT_EQ(episode.environment.size(), 3u);
  const std::vector<double> expected = {0, 4, 0, 0, 0, 0, 1};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(episode.environment[1][i], expected[i], 1e-12);
}

TEST(PackedEpisode, KeypointsOfAClothAreItsNodesInTheRecord) {
  const TestFolder root;
  const PackedEpisode episode = read_packed_episode(write_small_episode(root, "a", 0, 3, "", true, true), {});
  ASSERT_EQ(episode.environment_columns.size(), 7u + 24u);
  EXPECT_EQ(episode.environment_columns[7].name, "towel_corner_0_x");
  const std::vector<double> around_x = {0, 1, 2, 2, 2, 1, 0, 0}, around_y = {0, 0, 0, 1, 2, 2, 2, 1};
  for (std::size_t f = 0; f < 3; ++f)
    for (std::size_t k = 0; k < 8; ++k) {
      const double* const keypoint = &episode.environment[f][7 + 3 * k];
      EXPECT_EQ(keypoint[0], around_x[k]) << k;
      EXPECT_EQ(keypoint[1], around_y[k]) << k;
      EXPECT_EQ(keypoint[2], 2.0 * double(f + 1)) << k;  // the picture is taken at the end of step 2 f + 1
    }
}

TEST(PackedEpisode, PoseNumbersAreThoseOfTheNearestRotation) {
  // a strained turn by 90 degrees about x, then by 240 degrees about z, whose w would be negative
  Eigen::Matrix<double, 3, 4> map = Eigen::Matrix<double, 3, 4>::Zero();
  map.leftCols<3>() = 1.01 * Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX()).toRotationMatrix();
  map.col(3) = Eigen::Vector3d(1, 2, 3);
  const double half = std::sqrt(0.5);
  const std::array<double, 7> about_x = {1, 2, 3, half, 0, 0, half};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(pose_numbers(map)[i], about_x[i], 1e-12);
  map.leftCols<3>() = Eigen::AngleAxisd(4.0 / 3 * std::acos(-1.0), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const std::array<double, 7> about_z = {1, 2, 3, 0, 0, -std::sqrt(0.75), 0.5};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(pose_numbers(map)[i], about_z[i], 1e-12);
}

TEST(PackedEpisode, StatesWithoutPicturesHaveTheRowsThatPicturesWouldHave) {
  const TestFolder root;
  const PackedEpisode filmed = read_packed_episode(write_small_episode(root, "a", 0), {});
  const PackedEpisode dark = read_packed_states(write_small_episode(root, "b", 0, 3, "", false));
  EXPECT_EQ(dark.state, filmed.state);
  EXPECT_EQ(dark.action, filmed.action);
  EXPECT_EQ(dark.environment, filmed.environment);
  EXPECT_TRUE(dark.cameras.empty());
}

TEST(PackedEpisode, OneThatIsShorterThanAPeriodIsRefused) {
  const TestFolder root;
  const std::filesystem::path folder = write_small_episode(root, "a", 0, 3, "", false);
  root.write("a/summary.json", R"({"frames_per_second": 1.0, "cameras": {}})");  // of 0.6 s
  expect_error<UsageError>([&] { read_packed_states(folder); }, {"shorter than one period", "1 pictures per second"});
}

TEST(PackedEpisode, TheFirstRowIsTheStartAndItsActionThatOfTheFirstPeriod) {
  const TestFolder root;
  const PackedEpisode episode =
      read_packed_episode(write_small_episode(root, "a", 0, 3, "", true, true, true), {}, true);
  EXPECT_EQ(episode.state, (Rows{{0, 0}, {2, 0.04}, {4, 0.08}, {6, 0.12}}));
  EXPECT_EQ(episode.action, (Rows{{20, 0.08}, {40, 0.16}, {60, 0.24}, {60, 0.24}}));
  EXPECT_EQ(episode.velocity[0], (std::vector<double>{0, 0}));
  EXPECT_NEAR(episode.velocity[1][0], 10, 1e-12);
  EXPECT_NEAR(episode.tools[0].pose[0](0, 3), 0, 1e-12);
  EXPECT_EQ(episode.tools[0].width_action, (std::vector<double>{0.08, 0.16, 0.24, 0.24}));
  EXPECT_EQ(episode.objects[0].pose.size(), 4u);
  EXPECT_EQ(episode.objects[0].pose[0](1, 3), 0);
  ASSERT_EQ(episode.environment.size(), 4u);
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_NEAR(episode.environment[f][1], 2.0 * double(f), 1e-12);  // the cup's y
    EXPECT_EQ(episode.environment[f][9], 2.0 * double(f));           // z of the towel's first keypoint
  }
  ASSERT_EQ(episode.cameras[0].T_world_camera.size(), 4u);
  EXPECT_EQ(episode.cameras[0].T_world_camera[0][3], 0);
  EXPECT_EQ(episode.cameras[0].T_world_camera[1][3], 2);
  ASSERT_EQ(episode.cameras[0].K.size(), 4u);
  std::vector<int> greys;
  read_pictures(episode.cameras[0], 4, 0, [&](auto rgb) { greys.push_back(rgb[0]); });
  for (const auto& [f, grey] : {std::pair(0, 20), {1, 40}, {2, 80}, {3, 120}}) EXPECT_NEAR(greys[f], grey, 2) << f;
  // the same joints without pictures
  EXPECT_EQ(read_packed_states(root.path / "a", true).state, episode.state);
}

TEST(PackedEpisode, AnEpisodeOfEarlierVersionsLacksItsStart) {
  const TestFolder root;
  const auto earlier = write_small_episode(root, "a", 0),
             whole = write_small_episode(root, "b", 0, 3, "", true, false, true);
  EXPECT_FALSE(has_packed_start(earlier, {}));
  EXPECT_FALSE(has_packed_start_of_states(earlier));
  EXPECT_TRUE(has_packed_start(whole, {}));
  EXPECT_TRUE(has_packed_start(whole, {"wrist"}));
  EXPECT_TRUE(has_packed_start(whole, {"front"}));  // no such camera: reading refuses it
  expect_error<UsageError>([&] { read_packed_episode(earlier, {}, true); }, {"states.h5", "/start/q", "again"});
  std::filesystem::remove(start_video(whole, "wrist"));
  EXPECT_FALSE(has_packed_start(whole, {}));
  EXPECT_TRUE(has_packed_start_of_states(whole));
}

TEST(PackedEpisode, WhatCannotBePackedIsNamed) {
  const TestFolder root;
  const auto path = write_small_episode(root, "a", 0);
  expect_error<UsageError>([&] { read_packed_episode(path, {"front"}); }, {"/a", "`front`"});
  const auto dark = write_small_episode(root, "b", 0, 0);
  expect_error<UsageError>([&] { read_packed_episode(dark, {}); }, {"/b", "no pictures", "--no-render"});
  root.write("a/summary.json", "{}");
  expect_error<UsageError>([&] { read_packed_episode(path, {}); }, {"summary.json"});
  const PackedCamera camera{"wrist", SMALL_WIDTH, SMALL_HEIGHT, "", path / "wrist.mp4", {}, {}, false};
  expect_error<Failure>([&] { read_pictures(camera, 4, 0, [](auto) {}); }, {"wrist.mp4", "3 pictures", "4"});
}

TEST(PackedEpisode, TheSetKnowsItsLongestEpisodeAndTheReachOfItsActions) {
  const TestFolder root;
  const PackedEpisode first = read_packed_episode(write_small_episode(root, "a", 0), {});
  PackedSet set;
  add(set, first, first);
  add(set, first, read_packed_episode(write_small_episode(root, "b", 1, 5), {}));
  EXPECT_EQ(set.n_episodes, 2u);
  EXPECT_EQ(set.n_frames, 8u);
  EXPECT_EQ(set.most_frames, 5u);
  EXPECT_EQ(set.least_action, (std::vector<double>{40, 0.16}));
  EXPECT_EQ(set.most_action, (std::vector<double>{100, 0.4}));
  PackedEpisode other = first;
  other.columns[0] = "joint9";
  EXPECT_THROW(add(set, first, other), UsageError);
}

}  // namespace
}  // namespace pvg
