// ACT's layout: equal lengths by repeating the last row, pictures as arrays.
#include "host/dataset/act_files.hpp"

#include "host/hdf5/file.hpp"
#include "tests/dataset/small_episode.hpp"

namespace pvg {
namespace {

TEST(ActFiles, ShortEpisodesAreFilledUpByTheirLastRow) {
  const TestFolder root;
  const auto writer = make_act_writer(root.path, 4);
  writer->add(read_packed_episode(write_small_episode(root, "a", 0), {}));
  writer->finish();
  const hdf5::File file = hdf5::File::open(root.path / "episode_0.hdf5");
  EXPECT_EQ(file.read<float>("/observations/qpos").values,
            (std::vector<float>{2, 0.04f, 4, 0.08f, 6, 0.12f, 6, 0.12f}));
  EXPECT_EQ(file.read<float>("/action").values, (std::vector<float>{40, 0.16f, 60, 0.24f, 60, 0.24f, 60, 0.24f}));
  EXPECT_EQ(file.read<std::uint8_t>("/is_pad").values, (std::vector<std::uint8_t>{0, 0, 0, 1}));
  EXPECT_EQ(file.number_attribute("/", "sim"), 1);
  EXPECT_EQ(file.number_attribute("/", "length"), 3);
  const auto pictures = file.read<std::uint8_t>("/observations/images/wrist");
  ASSERT_EQ(pictures.shape, (hdf5::Shape{4, SMALL_HEIGHT, SMALL_WIDTH, 3}));
  const std::size_t size = SMALL_HEIGHT * SMALL_WIDTH * 3;
  for (std::size_t f = 0; f < 4; ++f) EXPECT_NEAR(pictures.values[f * size], f == 0 ? 40 : f == 1 ? 80 : 120, 2) << f;
}

}  // namespace
}  // namespace pvg
