// Do surfaces intersect? Exact for the given doubles: signs of determinants by a floating-point filter, and by
// expansion arithmetic (Shewchuk 1997, "Adaptive precision floating-point arithmetic") where the filter cannot tell.
// Touching counts as intersecting. Two triangles intersect where an edge of one meets the other.
#pragma once
#include <functional>
#include <optional>
#include <span>

#include "host/geometry/mesh.hpp"

namespace pvg {

// Sign of det [b-a, c-a, d-a]: positive where d lies on the side of triangle abc from which it runs counter-clockwise
// seen from the other side; +1, 0 or -1, exact barring underflow.
int orientation_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// The closed segment ab and the closed triangle, degenerate ones included.
bool intersects(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1, const Vec3& t2);

struct IntersectingPair {
  std::uint32_t edge = 0, triangle = 0;  // indices into what was given
};

// The first edge, in order, that meets a triangle; pairs that share a point and those that `is_excluded` names are left
// out. points: [n_points, m]
std::optional<IntersectingPair> find_intersection(
    std::span<const Vec3> points, std::span<const Edge> edges, std::span<const Triangle> triangles,
    const std::function<bool(std::uint32_t edge, std::uint32_t triangle)>& is_excluded = {});

// The same over the edges of the triangles. group: of each triangle (a body); collides_with_itself: of each group;
// empty: all do. Returns indices of two triangles: `edge` is the one whose edge meets the other.
std::optional<IntersectingPair> find_intersection(std::span<const Vec3> points, std::span<const Triangle> triangles,
                                                  std::span<const std::uint32_t> group = {},
                                                  std::span<const std::uint8_t> collides_with_itself = {});

}  // namespace pvg
