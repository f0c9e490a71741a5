// What a data set's row holds, from an episode whose numbers are known (small_episode.hpp).
#include "host/dataset/packed_episode.hpp"

#include "host/base/error.hpp"
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

TEST(PackedEpisode, WhatCannotBePackedIsNamed) {
  const TestFolder root;
  const auto path = write_small_episode(root, "a", 0);
  expect_error<UsageError>([&] { read_packed_episode(path, {"front"}); }, {"/a", "`front`"});
  const auto dark = write_small_episode(root, "b", 0, 0);
  expect_error<UsageError>([&] { read_packed_episode(dark, {}); }, {"/b", "no pictures", "--no-render"});
  root.write("a/summary.json", "{}");
  expect_error<UsageError>([&] { read_packed_episode(path, {}); }, {"summary.json"});
  EXPECT_THROW(demand_frames({"wrist", 0, 0, "wrist.mp4", {}, {}, false}, 3, 2), Failure);
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
