#include "host/pictures/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace pvg {
namespace {

using Color = std::array<double, 3>;
constexpr std::array<Color, 5> SCALE = {{{0, 0, 0}, {40, 40, 160}, {200, 30, 40}, {250, 210, 60}, {255, 255, 255}}};
constexpr double BACKGROUND = 0.55;  // of the picture's brightness below outlines

bool is_outline(std::span<const std::uint8_t> mask, int width, int height, int x, int y) {
  const auto at = [&](int u, int v) {
    return u >= 0 && v >= 0 && u < width && v < height && mask[std::size_t(v) * std::size_t(width) + std::size_t(u)];
  };
  return at(x, y) && !(at(x - 1, y) && at(x + 1, y) && at(x, y - 1) && at(x, y + 1));
}

std::uint8_t byte(double value) { return std::uint8_t(std::lround(std::clamp(value, 0.0, 255.0))); }

}  // namespace

Picture8 outline_overlay(const Picture8& picture, std::span<const std::uint8_t> real,
                         std::span<const std::uint8_t> simulated) {
  Picture8 shown = picture;
  for (std::uint8_t& value : shown.rgb) value = byte(BACKGROUND * value);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const bool is_real = is_outline(real, picture.width, picture.height, x, y);
      const bool is_simulated = is_outline(simulated, picture.width, picture.height, x, y);
      if (!is_real && !is_simulated) continue;
      std::uint8_t* pixel = &shown.rgb[3 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x))];
      pixel[0] = is_simulated ? 255 : 0;
      pixel[1] = is_real ? 255 : 0;
      pixel[2] = is_simulated ? 255 : 0;
    }
  return shown;
}

Picture8 error_map(const Picture8& a, const Picture8& b, double most) {
  Picture8 shown{a.width, a.height, std::vector<std::uint8_t>(a.rgb.size())};
  for (std::size_t i = 0; i + 2 < a.rgb.size(); i += 3) {
    double difference = 0;
    for (std::size_t c = 0; c < 3; ++c) difference += std::abs(int(a.rgb[i + c]) - int(b.rgb[i + c])) / (3 * 255.0);
    const double at = std::min(1.0, difference / most) * double(SCALE.size() - 1);
    const std::size_t k = std::min(std::size_t(at), SCALE.size() - 2);
    for (std::size_t c = 0; c < 3; ++c)
      shown.rgb[i + c] = byte(SCALE[k][c] + (at - double(k)) * (SCALE[k + 1][c] - SCALE[k][c]));
  }
  return shown;
}

}  // namespace pvg
