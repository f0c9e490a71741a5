#include "host/capture/objects/nearest_triangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "host/geometry/segment_distance.hpp"

namespace pvg {
namespace {

constexpr std::uint32_t LEAF = 4;
constexpr std::size_t MOST_LEVELS = 32;  // of halves of the triangles, whose number has 32 bits

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

// The distance where it is less than `below`, otherwise `below`; any distance up to `enough` ends the search.
double NearestTriangle::nearest(const Vec3& p, double below, double enough) const {
  struct Open {
    std::uint32_t node;
    double distance;  // of its box
  };
  std::array<Open, 2 * MOST_LEVELS> open;
  std::size_t n_open = 0;
  double best = below;
  open[n_open++] = {0, box_distance(p, nodes_[0].low, nodes_[0].high)};
  while (n_open > 0 && best > enough) {
    const Open next = open[--n_open];
    if (next.distance >= best) continue;
    const Node& node = nodes_[next.node];
    for (std::uint32_t i = node.first; node.count > 0 && i < node.first + node.count; ++i) {
      const Triangle& t = mesh_->triangles[order_[i]];
      best = std::min(best, point_triangle_distance(p, mesh_->points[t[0]], mesh_->points[t[1]], mesh_->points[t[2]]));
    }
    if (node.count > 0) continue;
    const Node &a = nodes_[node.first], &b = nodes_[node.first + 1];
    const Open near = {node.first, box_distance(p, a.low, a.high)},
               far = {node.first + 1, box_distance(p, b.low, b.high)};
    const bool a_is_nearer = near.distance <= far.distance;
    open[n_open++] = a_is_nearer ? far : near;  // the nearer one is looked at first
    open[n_open++] = a_is_nearer ? near : far;
  }
  return best;
}

double NearestTriangle::distance(const Vec3& p) const { return nearest(p, INFINITY, 0); }

bool NearestTriangle::is_within(const Vec3& p, double most) const {
  return nearest(p, std::nextafter(most, INFINITY), most) <= most;
}

}  // namespace pvg
