// Pictures: the sRGB curve at known points, PNG there and back, the contact sheet shows the right pixels in the right
// place.
#include "host/dataset/contact_sheet.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "host/base/error.hpp"
#include "host/formats/pixel_font.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

TEST(PictureFiles, SrgbCurveHasTheStandardsValues) {
  EXPECT_EQ(srgb8_from_linear(0.0f), 0);
  EXPECT_EQ(srgb8_from_linear(1.0f), 255);
  EXPECT_EQ(srgb8_from_linear(7.0f), 255);
  EXPECT_EQ(srgb8_from_linear(-1.0f), 0);
  EXPECT_EQ(srgb8_from_linear(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(srgb8_from_linear(0.215861f), 128);  // (128 / 255 + 0.055) / 1.055 to the power of 2.4
  EXPECT_EQ(srgb8_from_linear(0.002f), 7);       // 255 * 12.92 * 0.002 = 6.59
}

TEST(PictureFiles, PngComesBackBitByBit) {
  Picture8 picture{7, 3, std::vector<std::uint8_t>(63)};
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) picture.rgb[i] = std::uint8_t(i * 37);
  const auto path = std::filesystem::temp_directory_path() / ("pvg_png_" + std::to_string(getpid()) + ".png");
  write_picture(path, picture);
  const Picture8 back = read_picture(path);
  EXPECT_EQ(back.width, 7);
  EXPECT_EQ(back.height, 3);
  EXPECT_EQ(back.rgb, picture.rgb);
  std::filesystem::remove(path);
  EXPECT_THROW(write_picture("/no/such/folder/a.png", picture), Failure);
}

TEST(ContactSheet, FramesAreSpreadEvenlyFromFirstToLast) {
  EXPECT_EQ(evenly_spread(0, 6), (std::vector<std::size_t>{}));
  EXPECT_EQ(evenly_spread(1, 6), (std::vector<std::size_t>{0}));
  EXPECT_EQ(evenly_spread(3, 6), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(evenly_spread(11, 6), (std::vector<std::size_t>{0, 2, 4, 6, 8, 10}));
  const auto chosen = evenly_spread(97, 8);
  EXPECT_EQ(chosen.front(), 0u);
  EXPECT_EQ(chosen.back(), 96u);
  EXPECT_EQ(chosen.size(), 8u);
}

TEST(ContactSheet, EveryPictureStandsOnThePageOnceAndWhole) {
  ContactSheet sheet{"weigh beaker", {"fixed", "wrist"}, {"0.0 s", "1.0 s", "2.0 s"}, {}};
  for (int r = 0; r < 2; ++r) {
    sheet.pictures.emplace_back();
    for (int c = 0; c < 3; ++c)
      sheet.pictures.back().push_back({20, 10, std::vector<std::uint8_t>(600, std::uint8_t(40 * (1 + r * 3 + c)))});
  }
  for (const std::size_t beside : {1, 2, 3, 8}) {
    sheet.columns_beside = beside;
    const Picture8 page = lay_out(sheet);
    for (int value = 1; value <= 6; ++value) {
      int n = 0;
      for (std::size_t p = 0; p < page.rgb.size(); p += 3)
        n += page.rgb[p] == 40 * value && page.rgb[p + 1] == 40 * value && page.rgb[p + 2] == 40 * value;
      EXPECT_EQ(n, 200) << "picture " << value << ", beside " << beside;
    }
  }
}

TEST(ContactSheet, PicturesOfUnequalSizeAreRefused) {
  const Picture8 a{2, 2, std::vector<std::uint8_t>(12)}, b{4, 2, std::vector<std::uint8_t>(24)};
  EXPECT_THROW(lay_out({"", {"fixed"}, {"0", "1"}, {{a, b}}}), Failure);
  EXPECT_THROW(lay_out({"", {"fixed"}, {"0", "1"}, {{a}}}), Failure);
  EXPECT_THROW(lay_out({"", {}, {"0"}, {{a}}}), Failure);
}

TEST(PixelFont, LettersDifferAndStayInsideThePicture) {
  std::vector<std::vector<std::uint8_t>> seen;
  for (const char letter : std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.,:-_/=()%+?")) {
    Picture8 picture{5, 7, std::vector<std::uint8_t>(105)};
    draw_text(picture, 0, 0, std::string(1, letter), 1, {255, 255, 255});
    for (const auto& other : seen) EXPECT_NE(picture.rgb, other) << letter;
    seen.push_back(picture.rgb);
  }
  Picture8 small{3, 3, std::vector<std::uint8_t>(27)};
  draw_text(small, -2, -2, "WIDE TEXT", 3, {1, 1, 1});  // must not write outside
}

}  // namespace
}  // namespace pvg
