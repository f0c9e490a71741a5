#include "host/physics/contact/friction_anchors.hpp"

#include <algorithm>

namespace pvg {

void attach_anchors(std::span<const FrictionAnchor> anchors, double h, std::span<Friction> rows) {
  for (Friction& row : rows) {
    const PairKey key = pair_key(row);
    const auto found = std::lower_bound(anchors.begin(), anchors.end(), key,
                                        [](const FrictionAnchor& a, const PairKey& k) { return a.pair < k; });
    Eigen::Map<Vec3> anchor(row.anchor);
    anchor.setZero();
    if (found == anchors.end() || found->pair != key) continue;
    const Eigen::Map<const Vec3> normal(row.normal);
    anchor = row.friction_velocity * h * (found->strain - found->strain.dot(normal) * normal);
  }
}

std::vector<FrictionAnchor> anchors_of(std::span<const Friction> rows, std::span<const double> strain) {
  std::vector<FrictionAnchor> anchors;
  for (std::size_t i = 0; i < rows.size(); ++i)
    anchors.push_back({pair_key(rows[i]), Eigen::Map<const Vec3>(&strain[3 * i])});
  // pairs of one world differ, so that the order is one
  std::sort(anchors.begin(), anchors.end(),
            [](const FrictionAnchor& a, const FrictionAnchor& b) { return a.pair < b.pair; });
  return anchors;
}

}  // namespace pvg
