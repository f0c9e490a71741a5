// Pictures of differences, pixel by pixel.
#include "host/pictures/comparison.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace pvg {
namespace {

std::array<int, 3> pixel(const Picture8& picture, int x, int y) {
  const std::uint8_t* p = &picture.rgb[std::size_t(3 * (y * picture.width + x))];
  return {p[0], p[1], p[2]};
}

TEST(Comparison, OutlinesAreGreenMagentaAndWhiteWhereTheyMeet) {
  const Picture8 grey{5, 5, std::vector<std::uint8_t>(75, 100)};
  std::vector<std::uint8_t> real(25, 0), simulated(25, 0);
  for (int y = 1; y < 4; ++y)
    for (int x = 1; x < 4; ++x) real[std::size_t(5 * y + x)] = 1;
  simulated[5 * 1 + 1] = simulated[5 * 4 + 4] = 1;
  const Picture8 shown = outline_overlay(grey, real, simulated);
  EXPECT_EQ(pixel(shown, 1, 1), (std::array<int, 3>{255, 255, 255}));
  EXPECT_EQ(pixel(shown, 3, 1), (std::array<int, 3>{0, 255, 0}));
  EXPECT_EQ(pixel(shown, 4, 4), (std::array<int, 3>{255, 0, 255}));
  EXPECT_EQ(pixel(shown, 2, 2), (std::array<int, 3>{55, 55, 55}));  // within, and no outline
}

TEST(Comparison, EqualPixelsAreBlackAndLargeErrorsWhite) {
  const Picture8 a{3, 1, {0, 0, 0, 10, 20, 30, 0, 0, 0}}, b{3, 1, {255, 255, 255, 10, 20, 30, 96, 96, 0}};
  const Picture8 shown = error_map(a, b);
  EXPECT_EQ(pixel(shown, 0, 0), (std::array<int, 3>{255, 255, 255}));
  EXPECT_EQ(pixel(shown, 1, 0), (std::array<int, 3>{0, 0, 0}));
  // a mean of 64 / 255 of at most 0.25: just beyond the scale
  EXPECT_EQ(pixel(shown, 2, 0), (std::array<int, 3>{255, 255, 255}));
}

}  // namespace
}  // namespace pvg
