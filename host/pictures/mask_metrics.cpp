#include "host/pictures/mask_metrics.hpp"

#include "host/base/error.hpp"

namespace pvg {

std::array<double, N_MASK_MOMENTS> mask_moments(std::span<const std::uint8_t> mask, int width, int height) {
  if (mask.size() != std::size_t(width) * std::size_t(height))
    throw Failure("a mask of another size than its picture was given");
  std::array<double, N_MASK_MOMENTS> m{};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      if (!mask[std::size_t(row) * std::size_t(width) + std::size_t(column)]) continue;
      const double x = (2.0 * column + 1) / width - 1, y = (2.0 * row + 1) / height - 1;
      const std::array<double, N_MASK_MOMENTS> terms = {1, x, y, x * x, x * y, y * y};
      for (std::size_t k = 0; k < m.size(); ++k) m[k] += terms[k];
    }
  for (double& value : m) value /= double(mask.size());
  return m;
}

double mask_overlap(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  if (a.size() != b.size()) throw Failure("masks of different sizes were compared");
  std::size_t both = 0, any = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a[i] && b[i];
    any += a[i] || b[i];
  }
  return any == 0 ? 1 : double(both) / double(any);
}

}  // namespace pvg
