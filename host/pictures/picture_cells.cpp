#include "host/pictures/picture_cells.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

// linear(i): of the i-th value of [height x width x 3]
template <class Linear>
PictureCells means(std::size_t n_values, int width, int height, const Linear& linear) {
  if (n_values != 3 * std::size_t(width) * std::size_t(height))
    throw Failure("a picture of another size than its camera's was given");
  PictureCells sum{};
  std::array<std::size_t, N_PICTURE_CELLS> n{};
  std::size_t i = 0;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column, i += 3) {
      const std::size_t cell = std::size_t(CELL_COLUMNS * (row * CELL_ROWS / height) + column * CELL_COLUMNS / width);
      sum[cell] += 0.2126 * linear(i) + 0.7152 * linear(i + 1) + 0.0722 * linear(i + 2);
      ++n[cell];
    }
  for (std::size_t cell = 0; cell < sum.size(); ++cell) sum[cell] /= double(std::max<std::size_t>(n[cell], 1));
  return sum;
}

std::array<float, 256> srgb8_table() {
  std::array<float, 256> table;
  for (std::size_t byte = 0; byte < table.size(); ++byte) table[byte] = srgb_to_linear(float(byte) / 255);
  return table;
}

}  // namespace

PictureCells cell_luminance(std::span<const float> rgb, int width, int height) {
  return means(rgb.size(), width, height, [&](std::size_t i) { return double(std::clamp(rgb[i], 0.0f, 1.0f)); });
}

PictureCells cell_luminance(std::span<const std::uint8_t> rgb, int width, int height) {
  static const std::array<float, 256> LINEAR = srgb8_table();
  return means(rgb.size(), width, height, [&](std::size_t i) { return double(LINEAR[rgb[i]]); });
}

std::string cell_name(std::size_t cell) {
  return "column " + std::to_string(cell % CELL_COLUMNS + 1) + " row " + std::to_string(cell / CELL_COLUMNS + 1);
}

double srgb8_step_sigma(double linear) {
  const float byte = 255 * linear_to_srgb(std::clamp(float(linear), 0.0f, 1.0f));
  const float step = srgb_to_linear((byte + 0.5f) / 255) - srgb_to_linear((byte - 0.5f) / 255);
  return double(step) / std::sqrt(12.0);
}

}  // namespace pvg
