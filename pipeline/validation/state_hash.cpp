#include "pipeline/validation/state_hash.hpp"

namespace pvg {

void StateHash::add(const SceneState& state) {
  const auto add = [&](const double* values, std::size_t n) {
    value_ = fnv1a({reinterpret_cast<const char*>(values), sizeof(double) * n}, value_);
  };
  for (const AffineMap& map : state.rigid) add(map.data(), 12);
  for (const auto& points : state.soft)
    if (!points.empty()) add(points[0].data(), 3 * points.size());
  for (const auto& points : state.cloth)
    if (!points.empty()) add(points[0].data(), 3 * points.size());
}

}  // namespace pvg
