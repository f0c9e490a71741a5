// What a picture says in few numbers: the mean luminance Y = 0.2126 R + 0.7152 G + 0.0722 B (ITU-R BT.709) of linear
// light in each cell of a grid over it.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace pvg {

inline constexpr int CELL_COLUMNS = 4, CELL_ROWS = 3;
inline constexpr std::size_t N_PICTURE_CELLS = std::size_t(CELL_COLUMNS * CELL_ROWS);
using PictureCells = std::array<double, N_PICTURE_CELLS>;  // row by row from the top left

// rgb: linear, cut to [0, 1]  [height x width x 3]
PictureCells cell_luminance(std::span<const float> rgb, int width, int height);
// rgb: sRGB  [height x width x 3]
PictureCells cell_luminance(std::span<const std::uint8_t> rgb, int width, int height);

// "column 1 row 1" of the top left one
std::string cell_name(std::size_t cell);

// The standard deviation that 8 bits of sRGB leave of a linear value: the step between two bytes there over sqrt(12).
double srgb8_step_sigma(double linear);

}  // namespace pvg
