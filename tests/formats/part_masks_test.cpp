// Masks of a part, read from HDF5
#include "host/formats/part_masks.hpp"

#include <gtest/gtest.h>

#include "host/hdf5/file.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

// two pictures of 3 x 2 pixels with a table and a gripper; times as given, if there are any
std::filesystem::path pictures(const TestFolder& folder, const std::vector<double>& time) {
  const std::filesystem::path path = folder.path / "masks.h5";
  hdf5::File file = hdf5::File::create(path);
  file.write<std::uint8_t>("/part", {2, 2, 3},
                           std::vector<std::uint8_t>{0, 2, 2, 1, 1, 2,  //
                                                     2, 0, 0, 1, 1, 1});
  file.attribute("/part", "names", std::vector<std::string>{"nothing", "table", "gripper"});
  if (!time.empty()) file.write<double>("/time", {time.size()}, time);
  file.close();
  return path;
}

TEST(PartMasks, AreOneWhereThePartIsSeen) {
  const TestFolder folder;
  const PartMasks masks = read_part_masks(pictures(folder, {0.1, 0.2}), "gripper");
  EXPECT_EQ(masks.width, 3);
  EXPECT_EQ(masks.height, 2);
  EXPECT_EQ(masks.time, (std::vector<double>{0.1, 0.2}));
  ASSERT_EQ(masks.pixels.size(), 2u);
  EXPECT_EQ(masks.pixels[0], (std::vector<std::uint8_t>{0, 1, 1, 0, 0, 1}));
  EXPECT_EQ(masks.pixels[1], (std::vector<std::uint8_t>{1, 0, 0, 0, 0, 0}));
}

TEST(PartMasks, NeedNoTimes) {
  const TestFolder folder;
  EXPECT_TRUE(read_part_masks(pictures(folder, {}), "table").time.empty());
}

TEST(PartMasks, WhatDoesNotFitIsSaidWithTheFileAndWhatItHas) {
  const TestFolder folder;
  const std::filesystem::path path = pictures(folder, {0.1, 0.2, 0.3});
  expect_error<UsageError>([&] { read_part_masks(path, "wrist"); }, {"masks.h5", "`wrist`", "table, gripper"});
  expect_error<UsageError>([&] { read_part_masks(path, "nothing"); }, {"no part `nothing`"});
  expect_error<UsageError>([&] { read_part_masks(path, "gripper"); }, {"/time has 3", "2 masks"});
  expect_error<UsageError>([&] { read_part_masks(folder.path / "none.h5", "gripper"); }, {"none.h5"});
  hdf5::File::create(folder.path / "empty.h5").close();
  expect_error<UsageError>([&] { read_part_masks(folder.path / "empty.h5", "gripper"); }, {"empty.h5", "/part"});
}

}  // namespace
}  // namespace pvg
