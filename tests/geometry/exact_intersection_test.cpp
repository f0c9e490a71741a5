// The exact intersection test against integer arithmetic, and on cases that floating point alone gets wrong.
#include "host/geometry/exact_intersection.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/base/error.hpp"

namespace pvg {
namespace {

using Wide = __int128;
using Int3 = std::array<long long, 3>;

Int3 minus(const Int3& a, const Int3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Int3 cross(const Int3& a, const Int3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3 real(const Int3& a) { return Vec3(double(a[0]), double(a[1]), double(a[2])); }

int exact_sign(const Int3& a, const Int3& b, const Int3& c, const Int3& d) {
  const Int3 u = minus(b, a), v = minus(c, a), w = minus(d, a);
  Wide det = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    det += Wide(u[k]) * (Wide(v[i]) * w[j] - Wide(v[j]) * w[i]);
  }
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

// Two convex sets are apart where some axis separates them. All that a segment and a triangle, degenerate or not, may
// need: normals, edges, and crosses of these.
bool meet_by_separating_axes(const Int3* segment, const Int3* triangle) {
  std::vector<Int3> directions = {minus(segment[1], segment[0]), minus(triangle[1], triangle[0]),
                                  minus(triangle[2], triangle[1]), minus(triangle[0], triangle[2])};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 3; ++j) directions.push_back(minus(segment[i], triangle[j]));
  std::vector<Int3> axes = directions;
  for (std::size_t i = 0; i < directions.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) axes.push_back(cross(directions[i], directions[j]));
  const std::size_t n = axes.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < 4; ++j) axes.push_back(cross(axes[i], directions[j]));
  for (const Int3& axis : axes) {
    const auto along = [&](const Int3& p) { return axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]; };
    const auto [s0, s1] = std::minmax({along(segment[0]), along(segment[1])});
    const auto t = {along(triangle[0]), along(triangle[1]), along(triangle[2])};
    if (s1 < std::min(t) || std::max(t) < s0) return false;
  }
  return true;
}

TEST(ExactIntersection, SegmentAndTriangleOnASmallGridAgreeWithSeparatingAxes) {
  std::mt19937 random(3);
  int n_meet = 0, n_flat = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    Int3 p[5];
    // few places: half of the cases touch, lie in one plane or are degenerate
    for (Int3& point : p) point = {int(random() % 4), int(random() % 4), int(random() % 3)};
    const bool expected = meet_by_separating_axes(p, p + 2);
    ASSERT_EQ(intersects(real(p[0]), real(p[1]), real(p[2]), real(p[3]), real(p[4])), expected) << "trial " << trial;
    n_meet += expected;
    n_flat += exact_sign(p[2], p[3], p[4], p[0]) == 0 && exact_sign(p[2], p[3], p[4], p[1]) == 0;
  }
  EXPECT_GT(n_meet, 20000);
  EXPECT_GT(n_flat, 10000);
}

TEST(ExactIntersection, OrientationIsExactForNearlyCoplanarPoints) {
  std::mt19937_64 random(4);
  const auto place = [&] { return (long long)(random() >> 34); };  // 30 bits
  int n_zero = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    Int3 a = {place(), place(), place()}, b = {place(), place(), place()}, c = {place(), place(), place()};
    // a corner of the parallelogram, or one unit beside it
    Int3 d = {b[0] + c[0] - a[0], b[1] + c[1] - a[1], b[2] + c[2] - a[2]};
    d[trial % 3] += (long long)(random() % 3) - 1;
    const int expected = exact_sign(a, b, c, d);
    ASSERT_EQ(orientation_sign(real(a), real(b), real(c), real(d)), expected);
    // the same scaled to millimetres by a power of two
    ASSERT_EQ(orientation_sign(std::ldexp(1, -40) * real(a), std::ldexp(1, -40) * real(b), std::ldexp(1, -40) * real(c),
                               std::ldexp(1, -40) * real(d)),
              expected);
    n_zero += expected == 0;
  }
  EXPECT_GT(n_zero, 10000);
}

TEST(ExactIntersection, OneUnitInTheLastPlaceDecides) {
  const Vec3 t0(0, 0, 0.1), t1(1, 0, 0.1), t2(0, 1, 0.1), low(0.2, 0.2, 0);
  EXPECT_TRUE(intersects(low, Vec3(0.2, 0.2, 0.1), t0, t1, t2));
  EXPECT_FALSE(intersects(low, Vec3(0.2, 0.2, std::nextafter(0.1, 0)), t0, t1, t2));
  EXPECT_TRUE(intersects(Vec3(0.5, 0.5, 0), Vec3(0.5, 0.5, 1), t0, t1, t2));  // through the long side
  const double beyond = std::nextafter(0.5, 1);
  EXPECT_FALSE(intersects(Vec3(beyond, beyond, 0), Vec3(beyond, beyond, 1), t0, t1, t2));
}

struct Surface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
};

// a wavy sheet of n x n squares of `size` [m] at height z
Surface sheet(int n, double size, double z) {
  Surface s;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      s.points.push_back(Vec3(i * size, j * size, z + 0.3 * size * std::sin(0.7 * i + 0.4 * j)));
  for (std::uint32_t i = 0; i < std::uint32_t(n); ++i)
    for (std::uint32_t j = 0; j < std::uint32_t(n); ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      s.triangles.push_back({a, b, b + 1});
      s.triangles.push_back({a, b + 1, a + 1});
    }
  return s;
}

Surface joined(const Surface& first, const Surface& second) {
  Surface s = first;
  s.points.insert(s.points.end(), second.points.begin(), second.points.end());
  const auto shift = std::uint32_t(first.points.size());
  for (const Triangle& t : second.triangles) s.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return s;
}

TEST(ExactIntersection, FindsTheOneTriangleThatReachesThrough) {
  Surface s = joined(sheet(20, 0.01, 0), sheet(20, 0.01, 0.001));
  EXPECT_FALSE(find_intersection(s.points, s.triangles));
  const std::uint32_t pulled = 21 * 10 + 10 + 441;  // a point of the upper sheet
  s.points[pulled][2] -= 0.0015;
  const auto pair = find_intersection(s.points, s.triangles);
  ASSERT_TRUE(pair);
  EXPECT_NE(pair->edge < 800, pair->triangle < 800);
}

TEST(ExactIntersection, GroupsThatDoNotCollideWithThemselvesAreLeftOut) {
  const Surface s = joined(sheet(4, 0.01, 0), sheet(4, 0.01, 0));  // one in the other
  std::vector<std::uint32_t> group(s.triangles.size(), 0);
  const std::vector<std::uint8_t> rigid = {0, 0};
  EXPECT_TRUE(find_intersection(s.points, s.triangles));
  EXPECT_FALSE(find_intersection(s.points, s.triangles, group, rigid));
  std::fill(group.begin() + group.size() / 2, group.end(), 1);
  EXPECT_TRUE(find_intersection(s.points, s.triangles, group, rigid));
}

TEST(ExactIntersection, OnlyNeighboursAmongTenThousandTrianglesAreCompared) {
  const Surface s = joined(sheet(50, 0.01, 0), sheet(50, 0.01, 0.001));
  ASSERT_EQ(s.triangles.size(), 10000u);
  std::vector<Edge> edges;
  for (const Triangle& t : s.triangles)
    for (int k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
  std::size_t n_compared = 0;
  EXPECT_FALSE(find_intersection(s.points, edges, s.triangles, [&](std::uint32_t, std::uint32_t) {
    ++n_compared;
    return false;
  }));
  // the boxes that an edge's box can meet: triangles of its own sheet in some 4 x 4 cells, and none of the other sheet
  EXPECT_LT(n_compared, 32 * edges.size());
  EXPECT_GT(n_compared, edges.size());
}

TEST(ExactIntersection, PointsThatAreNoNumbersAreRefused) {
  Surface s = sheet(2, 0.01, 0);
  s.points[3][1] = NAN;
  EXPECT_THROW(find_intersection(s.points, s.triangles), Failure);
}

}  // namespace
}  // namespace pvg
