#include "host/pictures/seven_segments.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

constexpr int PLACE = 50, HEIGHT = 100;

int lit(const Texture& picture, int x0, int x1, int y0 = 0, int y1 = HEIGHT) {
  int count = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) count += picture.rgba[std::size_t(4 * (y * picture.width + x))] == 255;
  return count;
}

Texture shown(const std::string& figures, int n_places = 1) {
  return seven_segments(figures, n_places, PLACE * n_places, HEIGHT);
}

TEST(SevenSegments, EachDigitLightsItsSegments) {
  // a, b, c, d, e, f, g: a point inside each, as parts of the place
  const double inside[7][2] = {{0.45, 0.18}, {0.71, 0.3}, {0.71, 0.7}, {0.45, 0.82},
                               {0.19, 0.7},  {0.19, 0.3}, {0.45, 0.5}};
  const char* const wanted[10] = {"1111110", "0110000", "1101101", "1111001", "0110011",
                                  "1011011", "1011111", "1110000", "1111111", "1111011"};
  for (int digit = 0; digit < 10; ++digit) {
    const Texture picture = shown(std::to_string(digit));
    for (int segment = 0; segment < 7; ++segment) {
      const int x = int(inside[segment][0] * PLACE), y = int(inside[segment][1] * HEIGHT);
      EXPECT_EQ(lit(picture, x, x + 1, y, y + 1), wanted[digit][segment] - '0') << digit << " " << segment;
    }
  }
}

TEST(SevenSegments, FiguresStandFlushRightAndAPointTakesNoPlace) {
  const Texture picture = shown("1.8", 3);
  EXPECT_EQ(lit(picture, 0, PLACE), 0);
  EXPECT_EQ(lit(picture, PLACE, PLACE + PLACE * 8 / 10), lit(shown("1"), 0, PLACE));
  EXPECT_GT(lit(picture, PLACE + PLACE * 8 / 10, 2 * PLACE), 0);  // the point
  EXPECT_EQ(lit(picture, 2 * PLACE, 3 * PLACE), lit(shown("8"), 0, PLACE));
}

TEST(SevenSegments, AMinusIsItsMiddleAndNothingIsDark) {
  EXPECT_EQ(lit(shown("-"), 0, PLACE), lit(shown("-"), 0, PLACE, HEIGHT * 2 / 5, HEIGHT * 3 / 5));
  EXPECT_GT(lit(shown("-"), 0, PLACE), 0);
  EXPECT_EQ(lit(shown(""), 0, PLACE), 0);
}

}  // namespace
}  // namespace pvg
