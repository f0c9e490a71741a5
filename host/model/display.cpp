#include "host/model/display.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/pictures/seven_segments.hpp"

namespace pvg {

double load_on(const Display& display, const PhysicalScene& scene, const WorldState& state) {
  const double g = scene.gravity.norm();
  double load = 0;
  for (const PairForce& pair : state.pair_force) {
    if (pair.first != display.rigid && pair.second != display.rigid) continue;
    const double along_gravity = (pair.normal + pair.friction).dot(scene.gravity) * (g > 0 ? 1 / (g * g) : 0);
    load += std::max(0.0, pair.first == display.rigid ? along_gravity : -along_gravity);
  }
  return load - display.tare;
}

double settled(const Display& display, double reading, double load, double h) {
  const double share = display.time_constant > 0 ? -std::expm1(-h / display.time_constant) : 1;
  return reading + share * (load - reading);
}

std::vector<double> unloaded_readings(const PhysicalScene& scene) {
  std::vector<double> readings;
  for (const Display& display : scene.displays) readings.push_back(-display.tare);
  return readings;
}

std::string shown_figures(const Display& display, double reading) {
  constexpr double GRAMS = 1e3;  // in a kilogram
  const double step = display.resolution * GRAMS;
  // the resolution's own decimals: 0.1 g has one, 0.02 g has two
  const int decimals = std::max(0, int(std::ceil(-std::log10(step) - 1e-9)));
  const double rounded = std::round(reading / display.resolution) * step + 0.0;  // + 0: no "-0"
  char text[64];
  const int length = std::snprintf(text, sizeof text, "%.*f", decimals, rounded);
  const bool has_point = decimals > 0;
  if (!std::isfinite(reading) || length - int(has_point) > display.digits)
    return std::string(std::size_t(display.digits), '-');
  return text;
}

Texture face_picture(const Display& display, const std::string& figures) {
  constexpr int HEIGHT = 96;  // [texels]
  const int width = std::max(1, int(std::lround(HEIGHT * display.width / display.height)));
  return seven_segments(figures, display.digits, width, HEIGHT);
}

}  // namespace pvg
