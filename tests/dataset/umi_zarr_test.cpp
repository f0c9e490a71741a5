// UMI's layout, read back entry by entry with libarchive.
#include "host/dataset/umi_zarr.hpp"

#include <archive.h>
#include <archive_entry.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "tests/dataset/small_episode.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

std::map<std::string, std::string> entries_of(const std::filesystem::path& zip) {
  std::map<std::string, std::string> entries;
  archive* in = archive_read_new();
  archive_read_support_format_zip(in);
  EXPECT_EQ(archive_read_open_filename(in, zip.c_str(), 1 << 16), ARCHIVE_OK);
  for (archive_entry* entry = nullptr; archive_read_next_header(in, &entry) == ARCHIVE_OK;) {
    std::string& bytes = entries[archive_entry_pathname(entry)];
    char part[4096];
    for (la_ssize_t n; (n = archive_read_data(in, part, sizeof part)) > 0;) bytes.append(part, std::size_t(n));
  }
  archive_read_free(in);
  return entries;
}

std::vector<float> floats(const std::string& bytes) {
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

TEST(UmiZarr, HoldsPosesWidthsAndSquarePicturesInOneChunkEach) {
  const TestFolder root;
  const auto writer = make_umi_zarr_writer(root.path);
  writer->add(read_packed_episode(write_small_episode(root, "a", 0), {}));
  writer->add(read_packed_episode(write_small_episode(root, "b", 1, 2), {}));
  writer->finish();
  const auto entries = entries_of(root.path / "dataset.zarr.zip");
  const auto ends = entries.at("meta/episode_ends/0");
  std::int64_t end[2];
  ASSERT_EQ(ends.size(), sizeof end);
  std::memcpy(end, ends.data(), sizeof end);
  EXPECT_EQ(end[0], 3);
  EXPECT_EQ(end[1], 5);
  const std::vector<float> position = floats(entries.at("data/robot0_eef_pos/0.0"));
  EXPECT_EQ(position, (std::vector<float>{2, 0.5, 0, 4, 0.5, 0, 6, 0.5, 0, 2, 0.5, 0, 4, 0.5, 0}));
  const std::vector<float> turn = floats(entries.at("data/robot0_eef_rot_axis_angle/0.0"));
  EXPECT_NEAR(turn[2], std::acos(0.0), 1e-6);
  EXPECT_EQ(floats(entries.at("data/robot0_gripper_width/0.0")),
            (std::vector<float>{0.04f, 0.08f, 0.12f, 0.04f, 0.08f}));
  EXPECT_EQ(floats(entries.at("data/robot0_demo_end_pose/0.0"))[0], 6);
  const auto array = nlohmann::json::parse(entries.at("data/camera0_rgb/.zarray"));
  EXPECT_EQ(array["shape"].dump(), "[5,224,224,3]");
  EXPECT_EQ(array["chunks"].dump(), "[1,224,224,3]");
  const std::string& picture = entries.at("data/camera0_rgb/4.0.0.0");
  ASSERT_EQ(picture.size(), std::size_t(224 * 224 * 3));
  EXPECT_NEAR(std::uint8_t(picture[0]), 80, 2);
  EXPECT_EQ(nlohmann::json::parse(entries.at(".zgroup"))["zarr_format"], 2);
}

TEST(UmiZarr, AnEpisodeWithoutAGripperIsRefused) {
  const TestFolder root;
  PackedEpisode episode = read_packed_episode(write_small_episode(root, "a", 6), {});
  episode.tools.clear();
  const auto writer = make_umi_zarr_writer(root.path);
  expect_error<UsageError>([&] { writer->add(episode); }, {"episode 6", "gripper"});
}

}  // namespace
}  // namespace pvg
