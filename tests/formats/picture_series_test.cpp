// Videos as the luminance of their cells
#include "host/formats/picture_series.hpp"

#include <gtest/gtest.h>

#include "host/formats/picture_files.hpp"
#include "host/formats/video.hpp"
#include "host/hdf5/series.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

constexpr int SERIES_WIDTH = 32, SERIES_HEIGHT = 24;

// black, with the left column of cells of this grey
Picture8 picture(std::uint8_t grey) {
  Picture8 picture{SERIES_WIDTH, SERIES_HEIGHT, std::vector<std::uint8_t>(3 * SERIES_WIDTH * SERIES_HEIGHT, 0)};
  for (int i = 0; i < SERIES_WIDTH * SERIES_HEIGHT; ++i)
    if (i % SERIES_WIDTH < SERIES_WIDTH / 4) std::fill_n(picture.rgb.begin() + 3 * i, 3, grey);
  return picture;
}

void expect_series(const PictureSeries& series, double tolerance) {
  EXPECT_EQ(series.width, SERIES_WIDTH);
  EXPECT_EQ(series.height, SERIES_HEIGHT);
  ASSERT_EQ(series.cells.size(), 2u);
  EXPECT_NEAR(series.cells[0][4], 0.215861, tolerance);  // grey 128
  EXPECT_NEAR(series.cells[0][6], 0, tolerance);
  EXPECT_NEAR(series.cells[1][4], 0.577580, tolerance);  // grey 200
}

void write_h5(const std::filesystem::path& path, const std::vector<double>& time) {
  hdf5::File file = hdf5::File::create(path);
  std::vector<std::uint8_t> rgb = picture(128).rgb;
  for (const std::uint8_t value : picture(200).rgb) rgb.push_back(value);
  file.write("/rgb", {2, SERIES_HEIGHT, SERIES_WIDTH, 3}, rgb);
  if (!time.empty()) file.write("/time", {time.size()}, time);
  file.close();
}

TEST(PictureSeries, IsReadFromHDF5WithItsTimes) {
  const TestFolder folder;
  write_h5(folder.path / "video.h5", {0.5, 0.75});
  const PictureSeries series = read_picture_series(folder.path / "video.h5");
  expect_series(series, 1e-5);
  EXPECT_EQ(series.time, (std::vector<double>{0.5, 0.75}));
}

TEST(PictureSeries, IsReadFromNumberedPictures) {
  const TestFolder folder;
  write_picture(folder.path / "wrist_0001.png", picture(128));
  write_picture(folder.path / "wrist_0002.png", picture(200));
  const PictureSeries series = read_picture_series(folder.path / "wrist_%04d.png");
  expect_series(series, 1e-5);
  EXPECT_TRUE(series.time.empty());
}

TEST(PictureSeries, IsReadFromAVideo) {
  const TestFolder folder;
  VideoWriter writer(folder.path / "wrist.mp4", SERIES_WIDTH, SERIES_HEIGHT, 25);
  writer.write(picture(128).rgb);
  writer.write(picture(200).rgb);
  writer.finish();
  expect_series(read_picture_series(folder.path / "wrist.mp4"), 0.01);  // compressed
}

TEST(PictureSeries, WhatIsMissingOrDoesNotFitIsNamed) {
  const TestFolder folder;
  const auto refused = [&](const char* name, std::initializer_list<const char*> words) {
    expect_error<UsageError>([&] { read_picture_series(folder.path / name); }, words);
  };
  refused("none.h5", {"none.h5"});
  refused("none.mp4", {"none.mp4", "not there"});
  refused("none_%03d.png", {"none_000.png", "not there"});
  refused("one.png", {"one.png", "%06d"});
  write_h5(folder.path / "short.h5", {0.5, 0.6, 0.7});
  refused("short.h5", {"short.h5", "/time has 3", "2 pictures"});
  write_picture(folder.path / "gap_0.png", picture(1));
  write_picture(folder.path / "gap_2.png", picture(1));
  refused("gap_%d.png", {"gap_1.png", "missing"});
  write_picture(folder.path / "size_0.png", picture(1));
  write_picture(folder.path / "size_1.png", Picture8{16, 16, std::vector<std::uint8_t>(3 * 16 * 16, 0)});
  refused("size_%d.png", {"size_1.png", "another size"});
  hdf5::File::create(folder.path / "empty.h5").close();
  refused("empty.h5", {"empty.h5", "/rgb"});
  folder.write("text.mp4", "no video");
  refused("text.mp4", {"text.mp4"});
}

}  // namespace
}  // namespace pvg
