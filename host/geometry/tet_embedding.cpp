#include "host/geometry/tet_embedding.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/base/error.hpp"
#include "host/geometry/bvh.hpp"
#include "host/geometry/segment_distance.hpp"
#include "host/geometry/tet_mesh.hpp"

namespace pvg {
namespace {

std::vector<Box> element_boxes(const TetMesh& mesh) {
  std::vector<Box> boxes(mesh.n_elements());
  for (std::size_t e = 0; e < boxes.size(); ++e)
    for (int k = 0; k < 4; ++k) boxes[e].add(mesh.points[mesh.elements[4 * e + std::size_t(k)]].cast<float>());
  return boxes;
}

// 0 inside [m]
double distance_to_box(const BvhNode& node, int k, const Vec3& p) {
  const Vec3 lo(node.lo_x[k], node.lo_y[k], node.lo_z[k]), hi(node.hi_x[k], node.hi_y[k], node.hi_z[k]);
  return (lo - p).cwiseMax(p - hi).cwiseMax(0).norm();
}

// The tetrahedra of a mesh of 4-node elements, ready to be asked for the one nearest to a point.
class NearestTetrahedron {
 public:
  explicit NearestTetrahedron(const TetMesh& mesh) : mesh_(mesh), bvh_(build_bvh(element_boxes(mesh), 4)) {}

  struct Found {
    std::size_t element = 0;
    double distance = std::numeric_limits<double>::infinity();  // [m], 0: inside
  };
  Found operator()(const Vec3& p) const {
    Found found;
    visit(0, p, found);
    return found;
  }

  // barycentric weights; they sum to one also outside
  std::array<double, 4> weights(std::size_t element, const Vec3& p) const {
    const auto x = corners(element);
    Eigen::Matrix3d edges;
    edges << x[1] - x[0], x[2] - x[0], x[3] - x[0];
    const Vec3 w = edges.partialPivLu().solve(p - x[0]);
    return {1 - w.sum(), w.x(), w.y(), w.z()};
  }

 private:
  std::array<Vec3, 4> corners(std::size_t element) const {
    const std::uint32_t* n = &mesh_.elements[4 * element];
    return {mesh_.points[n[0]], mesh_.points[n[1]], mesh_.points[n[2]], mesh_.points[n[3]]};
  }

  double distance(std::size_t element, const Vec3& p) const {
    const std::array<double, 4> w = weights(element, p);
    if (*std::min_element(w.begin(), w.end()) >= 0) return 0;
    const auto x = corners(element);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 4; ++k)
      least = std::min(least, point_triangle_distance(p, x[k], x[(k + 1) % 4], x[(k + 2) % 4]));
    return least;
  }

  void visit(int index, const Vec3& p, Found& found) const {
    const BvhNode& node = bvh_.nodes[std::size_t(index)];
    std::array<std::pair<double, int>, BVH_WIDTH> children;  // nearest first; unused ones are endlessly far away
    for (int k = 0; k < BVH_WIDTH; ++k)
      children[std::size_t(k)] = {
          node.child[k] == BVH_EMPTY ? std::numeric_limits<double>::infinity() : distance_to_box(node, k, p),
          node.child[k]};
    std::sort(children.begin(), children.end());
    for (const auto& [away, child] : children) {
      if (away >= found.distance) return;
      if (child >= 0)
        visit(child, p, found);
      else
        try_leaf(bvh_.leaves[std::size_t(~child)], p, found);
    }
  }

  void try_leaf(const Bvh::Leaf& leaf, const Vec3& p, Found& found) const {
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      const std::size_t element = bvh_.order[i];
      const double away = distance(element, p);
      if (away < found.distance) found = {element, away};
    }
  }

  const TetMesh& mesh_;
  Bvh bvh_;
};

}  // namespace

Embedding embed_points(const TetMesh& mesh, std::span<const Vec3> points) {
  const TetMesh straight = straight_pieces(mesh);
  if (straight.elements.empty()) throw Failure("points cannot be embedded in a mesh without tetrahedra");
  const NearestTetrahedron nearest(straight);
  Embedding embedding;
  embedding.weights.n_columns = mesh.points.size();
  for (const Vec3& p : points) {
    const auto [element, distance] = nearest(p);
    const std::array<double, 4> weights = nearest.weights(element, p);
    std::array<std::pair<std::uint32_t, double>, 4> row;
    for (std::size_t k = 0; k < 4; ++k) row[k] = {straight.elements[4 * element + k], weights[k]};
    std::sort(row.begin(), row.end());
    for (const auto& [column, weight] : row) {
      embedding.weights.column.push_back(column);
      embedding.weights.weight.push_back(weight);
    }
    embedding.weights.row_start.push_back(std::uint32_t(embedding.weights.column.size()));
    embedding.distance.push_back(distance);
  }
  return embedding;
}

}  // namespace pvg
