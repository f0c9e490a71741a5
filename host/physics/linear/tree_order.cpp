#include "host/physics/linear/tree_order.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <numeric>

namespace pvg {
namespace {

struct PlacedItems {
  std::span<const Vec3> centroids;
  std::span<const std::uint32_t> body;
};

int longest_axis(const PlacedItems& items, std::span<const std::uint32_t> range) {
  Eigen::AlignedBox<double, 3> box;
  for (const std::uint32_t i : range) box.extend(items.centroids[i]);
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  return axis;
}

// range is sorted by body on entry; left: how many items the left child takes
void halve(const PlacedItems& items, std::span<std::uint32_t> range, std::size_t left) {
  const std::uint32_t body = items.body[range[left]];
  // the items of the body across which the cut runs
  const auto first = std::partition_point(range.begin(), range.end(), [&](auto i) { return items.body[i] < body; });
  const auto last = std::partition_point(first, range.end(), [&](auto i) { return items.body[i] == body; });
  const std::span<std::uint32_t> cut(first, last);
  const int axis = longest_axis(items, cut);
  std::nth_element(cut.begin(), range.begin() + left, cut.end(), [&](std::uint32_t i, std::uint32_t j) {
    const double a = items.centroids[i][axis], b = items.centroids[j][axis];
    return a < b || (a == b && i < j);
  });
}

// range: the items below a node of n_leaves leaves, sorted by body
void arrange(const PlacedItems& items, std::span<std::uint32_t> range, std::size_t n_leaves) {
  if (n_leaves < 2 || range.size() < 2) return;
  const std::size_t half = n_leaves / 2;
  if (range.size() <= half) return arrange(items, range, half);
  halve(items, range, half);
  arrange(items, range.first(half), half);
  arrange(items, range.subspan(half), half);
}

}  // namespace

std::vector<std::uint32_t> order_of_leaves(std::span<const Vec3> centroids, std::span<const std::uint32_t> body) {
  std::vector<std::uint32_t> order(centroids.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return body[i] < body[j]; });
  arrange({centroids, body}, order, std::bit_ceil(std::max<std::size_t>(order.size(), 1)));
  return order;
}

}  // namespace pvg
