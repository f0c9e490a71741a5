// Luminance of the cells of a picture
#include "host/pictures/picture_cells.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace pvg {
namespace {

TEST(PictureCells, AreMeansOfLuminanceOverTheirPixels) {
  const int width = 8, height = 6;  // cells of 2 x 2 pixels
  std::vector<float> rgb(std::size_t(3 * width * height), 0.0f);
  const auto at = [&](int column, int row) { return &rgb[std::size_t(3 * (row * width + column))]; };
  at(0, 0)[1] = 1;                // green, first cell
  at(7, 5)[0] = at(6, 4)[0] = 1;  // red, twice, last cell
  at(2, 3)[2] = 7;                // blue beyond white, cell of column 2 row 2
  const PictureCells cells = cell_luminance(rgb, width, height);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double expected = i == 0 ? 0.7152 / 4 : i == 11 ? 2 * 0.2126 / 4 : i == 5 ? 0.0722 / 4 : 0;
    EXPECT_NEAR(cells[i], expected, 1e-9) << cell_name(i);
  }
  EXPECT_EQ(cell_name(5), "column 2 row 2");
}

TEST(PictureCells, BytesAreDecodedAsSRGB) {
  const std::vector<std::uint8_t> grey(3 * 8 * 6, 128);
  for (const double cell : cell_luminance(grey, 8, 6)) EXPECT_NEAR(cell, 0.215861, 1e-5);  // IEC 61966-2-1
  // bytes 127 and 129 are 0.212231 and 0.219526
  EXPECT_NEAR(srgb8_step_sigma(0.215861), (0.219526 - 0.212231) / 2 / 3.4641016, 2e-6);
}

TEST(PictureCells, UnevenSizesLeaveNoPixelOut) {
  const std::vector<float> white(3 * 17 * 11, 1.0f);
  for (const double cell : cell_luminance(white, 17, 11)) EXPECT_NEAR(cell, 1, 1e-9);
}

}  // namespace
}  // namespace pvg
