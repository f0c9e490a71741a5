#include "pipeline/validation/state_hash.hpp"

#include <cstring>

namespace pvg {

void StateHash::add(const SceneState& state) {
  const auto add = [&](const double* values, std::size_t n) {
    for (std::size_t i = 0; i < 8 * n; ++i) {
      unsigned char byte = 0;
      std::memcpy(&byte, reinterpret_cast<const char*>(values) + i, 1);
      value_ = (value_ ^ byte) * 1099511628211ull;
    }
  };
  for (const AffineMap& map : state.rigid) add(map.data(), 12);
  for (const auto& points : state.soft)
    if (!points.empty()) add(points[0].data(), 3 * points.size());
  for (const auto& points : state.cloth)
    if (!points.empty()) add(points[0].data(), 3 * points.size());
}

}  // namespace pvg
