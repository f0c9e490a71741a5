#include "host/capture/objects/nearest_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/geometry/segment_distance.hpp"

namespace pvg {
namespace {

constexpr std::uint32_t LEAF = 4;

double box_distance(const Vec3& p, const Vec3& low, const Vec3& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).norm();
}

}  // namespace

NearestTriangle::NearestTriangle(const TriangleMesh& mesh) : mesh_(&mesh), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  for (const Triangle& t : mesh.triangles)
    center_.push_back((mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3);
  nodes_.emplace_back();
  divide(0, 0, std::uint32_t(order_.size()));
}

void NearestTriangle::divide(std::size_t node, std::uint32_t first, std::uint32_t last) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (std::uint32_t i = first; i < last; ++i)
    for (const std::uint32_t corner : mesh_->triangles[order_[i]]) {
      low = low.cwiseMin(mesh_->points[corner]);
      high = high.cwiseMax(mesh_->points[corner]);
    }
  nodes_[node] = {low, high, first, last - first};
  if (last - first <= LEAF) return;
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::uint32_t middle = (first + last) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::uint32_t i, std::uint32_t j) {
                     return center_[i][axis] != center_[j][axis] ? center_[i][axis] < center_[j][axis] : i < j;
                   });
  const std::size_t halves = nodes_.size();
  nodes_[node].first = std::uint32_t(halves);
  nodes_[node].count = 0;
  nodes_.resize(halves + 2);
  divide(halves, first, middle);
  divide(halves + 1, middle, last);
}

double NearestTriangle::distance(const Vec3& p) const {
  double best = INFINITY;
  std::vector<std::uint32_t> open = {0};
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (box_distance(p, node.low, node.high) >= best) continue;
    for (std::uint32_t i = node.first; node.count > 0 && i < node.first + node.count; ++i) {
      const Triangle& t = mesh_->triangles[order_[i]];
      best = std::min(best, point_triangle_distance(p, mesh_->points[t[0]], mesh_->points[t[1]], mesh_->points[t[2]]));
    }
    if (node.count > 0) continue;
    const Node &a = nodes_[node.first], &b = nodes_[node.first + 1];
    const bool a_is_nearer = box_distance(p, a.low, a.high) <= box_distance(p, b.low, b.high);
    open.push_back(a_is_nearer ? node.first + 1 : node.first);  // the nearer one is looked at first
    open.push_back(a_is_nearer ? node.first : node.first + 1);
  }
  return best;
}

}  // namespace pvg
