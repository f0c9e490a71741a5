#include "host/geometry/exact_intersection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <string>

#include "host/base/error.hpp"
#include "host/geometry/expansion.hpp"

namespace pvg {
namespace {

int sign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Expansion u[3], v[3], w[3];
  for (int k = 0; k < 3; ++k) {
    u[k] = Expansion::difference(b[k], a[k]);
    v[k] = Expansion::difference(c[k], a[k]);
    w[k] = Expansion::difference(d[k], a[k]);
  }
  return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]))
      .sign();
}

using Vec2 = Eigen::Vector2d;

// Sign of det [b-a, c-a]: +1 where abc runs counter-clockwise.
int orientation_sign(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
  const double det = left - right;
  // Shewchuk's bound: (3 + 16 u) u (|left| + |right|), u = 2^-53
  if (std::abs(det) > 4e-16 * (std::abs(left) + std::abs(right))) return sign(det);
  return (Expansion::difference(b[0], a[0]) * Expansion::difference(c[1], a[1]) -
          Expansion::difference(b[1], a[1]) * Expansion::difference(c[0], a[0]))
      .sign();
}

// c is on the line ab: is it on the segment?
bool is_between(const Vec2& a, const Vec2& b, const Vec2& c) {
  return std::min(a[0], b[0]) <= c[0] && c[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= c[1] &&
         c[1] <= std::max(a[1], b[1]);
}

bool intersects(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int abc = orientation_sign(a, b, c), abd = orientation_sign(a, b, d);
  const int cda = orientation_sign(c, d, a), cdb = orientation_sign(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && is_between(a, b, c)) || (abd == 0 && is_between(a, b, d)) || (cda == 0 && is_between(c, d, a)) ||
         (cdb == 0 && is_between(c, d, b));
}

bool is_inside(const Vec2& p, const Vec2* t) {
  const int s0 = orientation_sign(t[0], t[1], p), s1 = orientation_sign(t[1], t[2], p),
            s2 = orientation_sign(t[2], t[0], p);
  return s0 == s1 && s1 == s2 && s0 != 0;
}

Vec2 without(const Vec3& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

// All points lie in one plane, so along some axis its projection loses nothing: there the answer is exact, and along
// the others meeting is necessary.
bool coplanar_segments_intersect(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  for (int axis = 0; axis < 3; ++axis)
    if (!intersects(without(a, axis), without(b, axis), without(c, axis), without(d, axis))) return false;
  return true;
}

bool coplanar_intersects(const Vec3& a, const Vec3& b, const Vec3* t) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vec2 p = without(a, axis), q = without(b, axis);
    const Vec2 s[3] = {without(t[0], axis), without(t[1], axis), without(t[2], axis)};
    if (!intersects(p, q, s[0], s[1]) && !intersects(p, q, s[1], s[2]) && !intersects(p, q, s[2], s[0]) &&
        !is_inside(p, s))
      return false;
  }
  return true;
}

bool is_degenerate(const Vec3* t) {
  for (int axis = 0; axis < 3; ++axis)
    if (orientation_sign(without(t[0], axis), without(t[1], axis), without(t[2], axis)) != 0) return false;
  return true;
}

}  // namespace

int orientation_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const Vec3 n = v.cross(w);
  const double det = u.dot(n);
  const Vec3 p = v.cwiseAbs(), q = w.cwiseAbs();
  const Vec3 permanent(p[1] * q[2] + p[2] * q[1], p[2] * q[0] + p[0] * q[2], p[0] * q[1] + p[1] * q[0]);
  // Shewchuk's bound: (7 + 56 u) u times the permanent, u = 2^-53
  if (std::abs(det) > 8e-16 * u.cwiseAbs().dot(permanent)) return sign(det);
  return exact_orientation(a, b, c, d);
}

bool intersects(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1, const Vec3& t2) {
  const Vec3 t[3] = {t0, t1, t2};
  const int at_a = orientation_sign(t0, t1, t2, a), at_b = orientation_sign(t0, t1, t2, b);
  if (at_a * at_b > 0) return false;
  if (at_a == 0 && at_b == 0) {
    if (!is_degenerate(t)) return coplanar_intersects(a, b, t);
    // a triangle without area is its sides; each may lie in a plane with ab or not
    for (int k = 0; k < 3; ++k)
      if (orientation_sign(a, b, t[k], t[(k + 1) % 3]) == 0 && coplanar_segments_intersect(a, b, t[k], t[(k + 1) % 3]))
        return true;
    return false;
  }
  // ab crosses the plane: the line passes inside where it turns the same way around all three sides
  const int s0 = orientation_sign(a, b, t0, t1), s1 = orientation_sign(a, b, t1, t2),
            s2 = orientation_sign(a, b, t2, t0);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

namespace {

using ExactBox = Eigen::AlignedBox3d;

// Boxes of triangles in a binary tree: node k holds the items begin .. end of `order`, split at their middle.
struct Tree {
  struct Node {
    ExactBox box;
    std::size_t begin, end;
  };
  std::vector<Node> nodes;  // a node's left child follows it; `right` says where the right one is
  std::vector<std::size_t> right;
  std::vector<std::uint32_t> order;
  std::vector<ExactBox> boxes;

  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t self = nodes.size();
    ExactBox box, centers;
    for (std::size_t i = begin; i < end; ++i) {
      box.extend(boxes[order[i]]);
      centers.extend(boxes[order[i]].center());
    }
    nodes.push_back({box, begin, end});
    right.push_back(0);
    if (end - begin <= 4) return self;
    int axis = 0;
    centers.sizes().maxCoeff(&axis);
    const std::size_t middle = (begin + end) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](auto i, auto j) {
      const double a = boxes[i].center()[axis], b = boxes[j].center()[axis];
      return a < b || (a == b && i < j);
    });
    build(begin, middle);
    right[self] = build(middle, end);
    return self;
  }

  // calls visit(triangle) for every box that meets `box`, until it returns true
  template <class Visit>
  bool any(const ExactBox& box, const Visit& visit, std::size_t node = 0) const {
    if (nodes.empty() || !nodes[node].box.intersects(box)) return false;
    if (right[node]) return any(box, visit, node + 1) || any(box, visit, right[node]);
    for (std::size_t i = nodes[node].begin; i < nodes[node].end; ++i)
      if (boxes[order[i]].intersects(box) && visit(order[i])) return true;
    return false;
  }
};

Tree make_tree(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  Tree tree;
  for (const Triangle& t : triangles) {
    ExactBox box;
    for (const std::uint32_t corner : t) box.extend(points[corner]);
    tree.boxes.push_back(box);
  }
  tree.order.resize(triangles.size());
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  if (!triangles.empty()) tree.build(0, triangles.size());
  return tree;
}

void require_finite(std::span<const Vec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      throw Failure("point " + std::to_string(i) +
                    " of a surface is not a finite number; an intersection test needs all");
}

}  // namespace

std::optional<IntersectingPair> find_intersection(
    std::span<const Vec3> points, std::span<const Edge> edges, std::span<const Triangle> triangles,
    const std::function<bool(std::uint32_t, std::uint32_t)>& is_excluded) {
  require_finite(points);
  const Tree tree = make_tree(points, triangles);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const Vec3 &a = points[edges[e][0]], &b = points[edges[e][1]];
    ExactBox box(a);
    box.extend(b);
    IntersectingPair pair{e, 0};
    const bool is_found = tree.any(box, [&](std::uint32_t i) {
      const Triangle& t = triangles[i];
      const bool shares_a_point =
          std::any_of(t.begin(), t.end(), [&](auto corner) { return corner == edges[e][0] || corner == edges[e][1]; });
      pair.triangle = i;
      return !shares_a_point && !(is_excluded && is_excluded(e, i)) &&
             intersects(a, b, points[t[0]], points[t[1]], points[t[2]]);
    });
    if (is_found) return pair;
  }
  return std::nullopt;
}

std::optional<IntersectingPair> find_intersection(std::span<const Vec3> points, std::span<const Triangle> triangles,
                                                  std::span<const std::uint32_t> group,
                                                  std::span<const std::uint8_t> collides_with_itself) {
  std::vector<std::pair<Edge, std::uint32_t>> all;  // and a triangle that each belongs to
  all.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t p = triangles[i][k], q = triangles[i][(k + 1) % 3];
      all.push_back({{std::min(p, q), std::max(p, q)}, i});
    }
  std::sort(all.begin(), all.end());
  std::vector<Edge> edges;
  std::vector<std::uint32_t> triangle_of_edge;
  for (const auto& [edge, triangle] : all) {
    if (!edges.empty() && edges.back() == edge) continue;
    edges.push_back(edge);
    triangle_of_edge.push_back(triangle);
  }
  const auto is_excluded = [&](std::uint32_t edge, std::uint32_t triangle) {
    if (group.empty()) return false;
    const std::uint32_t g = group[triangle_of_edge[edge]];
    return g == group[triangle] && !collides_with_itself.empty() && !collides_with_itself[g];
  };
  auto pair = find_intersection(points, edges, triangles, is_excluded);
  if (pair) pair->edge = triangle_of_edge[pair->edge];
  return pair;
}

}  // namespace pvg
