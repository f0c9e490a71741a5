// Pictures come in as 8-bit sRGB with alpha; broken ones are named.
#include "host/formats/textures.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

TEST(Textures, ColourAndGreyGetAnOpaqueAlpha) {
  const TestFolder folder;
  // binary portable maps: two pixels in a row
  const Texture color = read_texture(folder.write("a.ppm", std::string("P6\n2 1\n255\n") + "\x10\x20\x30\x40\x50\x60"));
  ASSERT_EQ(color.width, 2);
  ASSERT_EQ(color.height, 1);
  EXPECT_EQ(color.rgba, (std::vector<std::uint8_t>{0x10, 0x20, 0x30, 255, 0x40, 0x50, 0x60, 255}));
  const Texture grey = read_texture(folder.write("a.pgm", std::string("P5\n1 2\n255\n") + "\x11\x22"));
  ASSERT_EQ(grey.height, 2);
  EXPECT_EQ(grey.rgba, (std::vector<std::uint8_t>{0x11, 0x11, 0x11, 255, 0x22, 0x22, 0x22, 255}));
}

TEST(Textures, TheBackgroundsPictureLoads) {
  const Texture lab = read_texture(std::string(PVG_DATA_FOLDER) + "/backgrounds/lab/lab.png");
  EXPECT_EQ(lab.width, 2048);
  EXPECT_EQ(lab.height, 1024);
  EXPECT_EQ(lab.rgba.size(), 2048u * 1024 * 4);
}

TEST(Textures, BrokenFilesAreNamed) {
  const TestFolder folder;
  expect_error<UsageError>([] { read_texture("/nowhere/wood.png"); }, {"/nowhere/wood.png", "no such"});
  const auto text = folder.write("text.png", "this is no picture");
  expect_error<UsageError>([&] { read_texture(text); }, {"text.png", "cannot be read as a picture"});
  std::ifstream in(std::string(PVG_DATA_FOLDER) + "/backgrounds/lab/lab.png", std::ios::binary);
  std::string half(20000, '\0');
  in.read(half.data(), std::streamsize(half.size()));
  const auto cut = folder.write("cut.png", half);
  expect_error<UsageError>([&] { read_texture(cut); }, {"cut.png", "damaged"});
}

}  // namespace
}  // namespace pvg
