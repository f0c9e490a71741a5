// A checkpoint comes back from its file with every bit, and what is no checkpoint is refused by name.
#include "host/dataset/checkpoint_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "host/base/error.hpp"

namespace pvg {
namespace {

std::filesystem::path checkpoint_path(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("pvg_checkpoint_" + std::to_string(getpid()) + "_" + name);
}

TEST(CheckpointFile, ComesBackWithEveryBit) {
  const auto path = checkpoint_path("whole.h5");
  SavedCheckpoint saved;
  Checkpoint& c = saved.checkpoint;
  c.position = {0.1, 1.0 / 3, -0.0, 5e-324, 1e308, 3};
  c.history = {{1, 2, 3, 4, 5, 6.7}, {7, 8, 9, 1, 2, 3}, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}, {6, 5, 4, 3, 2, 1}, {0.01, 0}};
  c.anchors = {{{{0, 4294967295, 2, 7, 9}, Vec3(1.0 / 3, -0.5, 5e-324)}, {{1, 5, 6, 7, 8}, Vec3(0, 0.1, 0.7)}}, {}};
  c.time = {0.25, 0.1 + 0.2};
  c.joint_position = {{1, 2}, {}};
  c.targets = {{}, {3, 4, 5}};
  saved.scene = "schema: 1\nname: \"a scene\"\n";
  write_checkpoint(path, saved);
  const SavedCheckpoint read = read_checkpoint(path);
  EXPECT_EQ(read.scene, saved.scene);
  EXPECT_EQ(read.checkpoint.position, c.position);
  EXPECT_TRUE(std::signbit(read.checkpoint.position[2]));
  EXPECT_EQ(read.checkpoint.history.velocity, c.history.velocity);
  EXPECT_EQ(read.checkpoint.history.position_before, c.history.position_before);
  EXPECT_EQ(read.checkpoint.history.velocity_before, c.history.velocity_before);
  EXPECT_EQ(read.checkpoint.history.velocity_two_before, c.history.velocity_two_before);
  EXPECT_EQ(read.checkpoint.history.length_before, c.history.length_before);
  ASSERT_EQ(read.checkpoint.anchors.size(), 2u);
  ASSERT_EQ(read.checkpoint.anchors[0].size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(read.checkpoint.anchors[0][i].pair, c.anchors[0][i].pair);
    EXPECT_EQ(read.checkpoint.anchors[0][i].strain, c.anchors[0][i].strain);
  }
  EXPECT_TRUE(read.checkpoint.anchors[1].empty());
  EXPECT_EQ(read.checkpoint.time, c.time);
  EXPECT_EQ(read.checkpoint.joint_position, c.joint_position);
  EXPECT_EQ(read.checkpoint.targets, c.targets);
  std::filesystem::remove(path);
}

TEST(CheckpointFile, OtherFilesAreRefusedByName) {
  const auto path = checkpoint_path("other.h5");
  EXPECT_THROW(read_checkpoint(path), UsageError);
  std::ofstream(path) << "no HDF5";
  try {
    read_checkpoint(path);
    FAIL() << "a text was read as a checkpoint";
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace pvg
