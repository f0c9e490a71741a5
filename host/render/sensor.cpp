#include "host/render/sensor.hpp"
#include "host/base/hash.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pvg {
namespace {

// standard normal, of a counter (Box and Muller 1958)
double normal_number(std::uint32_t key, std::uint64_t i) {
  const std::uint64_t bits = mixed_bits(mixed_bits(key) ^ i);
  const double u = (double(bits >> 32) + 1) * 0x1p-32, v = double(bits & 0xffffffffu) * 0x1p-32;
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

double vignetting(const Camera& camera, std::size_t pixel) {
  const double x = double(pixel % std::size_t(camera.width)) - camera.cx,
               y = double(pixel / std::size_t(camera.width)) - camera.cy;
  const double farthest_x = std::max(camera.cx + 0.5, camera.width - 0.5 - camera.cx),
               farthest_y = std::max(camera.cy + 0.5, camera.height - 0.5 - camera.cy);
  const double r2 = (x * x + y * y) / (farthest_x * farthest_x + farthest_y * farthest_y);
  double factor = 1, power = r2;
  for (const double v : camera.vignetting) {
    factor += v * power;
    power *= r2;
  }
  return std::max(0.0, factor);
}

}  // namespace

void expose_sensor(const Camera& camera, std::uint32_t key, std::vector<float>& rgb) {
  if (!camera.vignetting.empty())
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] *= float(vignetting(camera, i / 3));
  if (camera.full_well <= 0) return;
  const double N = camera.full_well, read = camera.read_noise;
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    const double sigma = std::sqrt(std::max(0.0, N * rgb[i]) + read * read) / N;
    rgb[i] = float(std::max(0.0, rgb[i] + sigma * normal_number(key, i)));
  }
}

}  // namespace pvg
