// The order of the leaves of a complete binary tree of boxes.
#pragma once
#include <span>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

// Items in the order of their leaves: every node's items are halved at the power of two that its left child holds, by
// body as long as there are several, then at the median along the longest side of their centroids.
// centroids: [n, m];  body: [n]
std::vector<std::uint32_t> order_of_leaves(std::span<const Vec3> centroids, std::span<const std::uint32_t> body);

}  // namespace pvg
