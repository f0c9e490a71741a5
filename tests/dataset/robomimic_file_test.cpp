// robomimic's layout: actions between -1 and 1 that can be turned back, observations and the next ones, MimicGen's
// poses.
#include "host/dataset/robomimic_file.hpp"

#include <nlohmann/json.hpp>

#include "host/hdf5/file.hpp"
#include "tests/dataset/small_episode.hpp"

namespace pvg {
namespace {

TEST(RobomimicFile, ActionsFillTheRangeAndCanBeTurnedBack) {
  const TestFolder root;
  const PackedEpisode first = read_packed_episode(write_small_episode(root, "a", 0), {});
  PackedSet set;
  add(set, first, first);
  add(set, first, first);
  const auto writer = make_robomimic_writer(root.path, set);
  writer->add(first);
  writer->add(first);
  writer->finish();

  const hdf5::File file = hdf5::File::open(root.path / "demo.hdf5");
  EXPECT_EQ(file.number_attribute("/data", "total"), 6);
  EXPECT_EQ(nlohmann::json::parse(file.text_attribute("/data", "env_args"))["env_name"], "lift_cup");
  EXPECT_EQ(file.children("/data"), (std::vector<std::string>{"demo_0", "demo_1"}));
  const auto actions = file.read<double>("/data/demo_1/actions").values,
             offset = file.read<double>("/action_offset").values, scale = file.read<double>("/action_scale").values;
  EXPECT_DOUBLE_EQ(actions[0], -1);
  EXPECT_DOUBLE_EQ(actions[2], 1);
  EXPECT_NEAR(actions[1] * scale[1] + offset[1], 0.16, 1e-12);
  EXPECT_EQ(file.read<double>("/data/demo_0/rewards").values, (std::vector<double>{0, 0, 1}));
  EXPECT_EQ(file.read<double>("/data/demo_0/obs/robot0_joint_pos").values,
            (std::vector<double>{2, 0.04, 4, 0.08, 6, 0.12}));
  EXPECT_EQ(file.read<double>("/data/demo_0/next_obs/robot0_joint_pos").values,
            (std::vector<double>{4, 0.08, 6, 0.12, 6, 0.12}));
  EXPECT_EQ(file.shape("/data/demo_0/states"), (hdf5::Shape{3, 2 + 12}));
  EXPECT_EQ(file.shape("/data/demo_0/next_obs/wrist_image"), (hdf5::Shape{3, SMALL_HEIGHT, SMALL_WIDTH, 3}));
  EXPECT_NEAR(file.read<std::uint8_t>("/data/demo_0/next_obs/wrist_image").values[0], 80, 2);
  const auto hand = file.read<double>("/data/demo_0/datagen_info/eef_pose");
  ASSERT_EQ(hand.shape, (hdf5::Shape{3, 4, 4}));
  EXPECT_NEAR(hand.values[7], 0.5, 1e-12);  // y of the tool frame
  EXPECT_EQ(file.read<double>("/data/demo_0/datagen_info/object_poses/cup").values[7], 2);
  EXPECT_EQ(file.shape("/mask/train"), hdf5::Shape{1});
  EXPECT_EQ(file.shape("/mask/valid"), hdf5::Shape{1});
}

}  // namespace
}  // namespace pvg
