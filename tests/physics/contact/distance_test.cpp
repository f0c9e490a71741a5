// Distances of the device against numbers by hand, and against nested minimisation in long double.
#include "host/device/device.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "energies/contact/barrier.h"
#include "host/geometry/segment_distance.hpp"
#include "shared/types.h"

namespace pvg {
namespace {

const char* const measure_text =
    "#include \"contact/distance.cl\"\n"
    "kernel void measure(const uint n, const uint kind, global const real* x, global real* out) {\n"
    "  const uint e = get_global_id(0); if (e >= n) return;\n"
    "  real3 p[4]; for (int i = 0; i < 4; ++i) p[i] = vload3(4 * e + i, x);\n"
    "  const Distance d = pair_distance(kind, p);\n"
    "  for (int i = 0; i < 4; ++i) out[8 * e + i] = d.c[i];\n"
    "  vstore3(d.n, 0, out + 8 * e + 4); out[8 * e + 7] = d.d; }\n";

using Four = std::array<Vec3, 4>;
struct Measured {
  double c[4];
  Vec3 n;
  double d;
};

class Distances : public ::testing::Test {
 protected:
  std::vector<Measured> measure(u32 kind, const std::vector<Four>& pairs) {
    std::vector<double> x;
    for (const Four& four : pairs)
      for (const Vec3& p : four) x.insert(x.end(), {p[0], p[1], p[2]});
    const Buffer<double> on_device(device_, x, "x");
    Buffer<double> out(device_, 8 * pairs.size(), "out");
    measure_(pairs.size(), u32(pairs.size()), kind, on_device, out);
    const std::vector<double> values = out.read();
    std::vector<Measured> found(pairs.size());
    for (std::size_t e = 0; e < pairs.size(); ++e) {
      const double* v = &values[8 * e];
      found[e] = {{v[0], v[1], v[2], v[3]}, Vec3(v[4], v[5], v[6]), v[7]};
    }
    return found;
  }

  Device device_;
  Program program_ = Program::from_text(device_, "measure.cl", measure_text);
  Kernel measure_ = program_.kernel("measure");
};

using Real = long double;
using Vec = Eigen::Matrix<Real, 3, 1>;

// minimum of a convex function on [0, 1] by golden section
template <class F>
Real minimum(const F& f) {
  const Real ratio = 0.61803398874989484820L;
  Real low = 0, high = 1, a = 1 - ratio, b = ratio, fa = f(a), fb = f(b), least = std::min(f(0), f(1));
  for (int k = 0; k < 60; ++k) {
    if (fa < fb) {
      high = b, b = a, fb = fa, a = high - ratio * (high - low), fa = f(a);
    } else {
      low = a, a = b, fa = fb, b = low + ratio * (high - low), fb = f(b);
    }
  }
  return std::min({least, fa, fb});
}

Real by_minimisation(u32 kind, const Four& x) {
  const Vec p[4] = {x[0].cast<Real>(), x[1].cast<Real>(), x[2].cast<Real>(), x[3].cast<Real>()};
  return std::sqrt(minimum([&](Real u) {
    return minimum([&](Real v) {
      const Vec first = kind == EDGE_EDGE ? Vec(p[0] + u * (p[1] - p[0])) : p[0];
      const Vec second = kind == EDGE_EDGE ? Vec(p[2] + v * (p[3] - p[2]))
                                           : Vec(p[1] + u * (p[2] - p[1]) + (1 - u) * v * (p[3] - p[1]));
      return Real((first - second).squaredNorm());
    });
  }));
}

class Points {
 public:
  explicit Points(unsigned seed) : engine_(seed) {}
  double number(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  Vec3 point(double size) { return Vec3(number(-size, size), number(-size, size), number(-size, size)); }

 private:
  std::mt19937 engine_;
};

// every way in which four points can be special
Four awkward(Points& random, int way) {
  Four x = {random.point(1), random.point(1), random.point(1), random.point(1)};
  const double tiny = std::pow(10.0, random.number(-12, -1));
  switch (way) {
    case 1:
      x[1] = x[2] + tiny * random.point(1);
      break;  // two corners nearly alike
    case 2:
      x[3] = x[1] + random.number(-1, 2) * (x[2] - x[1]) + tiny * random.point(1);
      break;  // needle
    case 3:
      x[3] = x[2] + (x[1] - x[0]) * random.number(-2, 2) + tiny * random.point(1);
      break;  // nearly parallel
    case 4:
      x[3] = x[2] + (x[1] - x[0]);
      break;  // parallel
    case 5:
      x[2] = x[0] + random.number(-1, 2) * (x[1] - x[0]);
      x[3] = x[0] + random.number(-1, 2) * (x[1] - x[0]);
      break;
    case 6:
      x[3] = x[2];
      break;  // an edge without length
    case 7:
      x[1] = x[2] = x[3];
      break;  // a triangle that is a point
    case 8:
      x[0] = 0.3 * x[1] + 0.3 * x[2] + 0.4 * x[3] + tiny * random.point(1);
      break;  // nearly touching
    case 9:
      x[0] = 0.3 * x[1] + 0.7 * x[2] + tiny * random.point(1);
      break;  // close to a side
    default:
      break;
  }
  return x;
}

std::vector<Four> all_ways(std::size_t n) {
  Points random(17);
  std::vector<Four> pairs(n);
  for (std::size_t i = 0; i < n; ++i) pairs[i] = awkward(random, int(i % 10));
  return pairs;
}

TEST_F(Distances, AgreeWithMinimisationForGeneralAndDegenerateShapes) {
  for (const std::size_t n : {0, 1, 3, 257, 1000})
    for (const u32 kind : {POINT_TRIANGLE, EDGE_EDGE}) {
      const std::vector<Four> pairs = all_ways(n);
      const std::vector<Measured> found = measure(kind, pairs);
      for (std::size_t e = 0; e < n; ++e) {
        const double expected = double(by_minimisation(kind, pairs[e]));
        // nearly parallel edges at 1e-7 keep their distance to 1e-9 of their size
        ASSERT_NEAR(found[e].d, expected, 2e-9) << "kind " << kind << " case " << e;
        ASSERT_GE(found[e].d, expected - 1e-12);
      }
    }
}

TEST_F(Distances, CoefficientsAndNormalDescribeTheDifference) {
  for (const u32 kind : {POINT_TRIANGLE, EDGE_EDGE}) {
    const std::vector<Four> pairs = all_ways(1000);
    const std::vector<Measured> found = measure(kind, pairs);
    for (std::size_t e = 0; e < pairs.size(); ++e) {
      const Measured& m = found[e];
      Vec3 difference = Vec3::Zero();
      for (int i = 0; i < 4; ++i) difference += m.c[i] * pairs[e][i];
      ASSERT_LE((difference - m.d * m.n).norm(), 1e-14);
      ASSERT_NEAR(m.n.norm(), m.d > 0 ? 1 : 0, 1e-14);
      const double first = kind == EDGE_EDGE ? m.c[0] + m.c[1] : m.c[0];
      ASSERT_NEAR(first, 1, 1e-15);
      ASSERT_NEAR(m.c[0] + m.c[1] + m.c[2] + m.c[3], 0, 1e-15);
      for (int i = 0; i < 4; ++i) {
        const bool is_first = kind == EDGE_EDGE ? i < 2 : i < 1;
        ASSERT_GE(is_first ? m.c[i] : -m.c[i], -1e-15);
      }
    }
  }
}

TEST_F(Distances, GradientIsCoefficientTimesNormal) {
  const double step = 1e-6;
  Points random(5);
  for (const u32 kind : {POINT_TRIANGLE, EDGE_EDGE})
    for (int e = 0; e < 100; ++e) {
      const Four x = awkward(random, 0);
      std::vector<Four> moved = {x};
      for (int i = 0; i < 12; ++i)
        for (const double sign : {1.0, -1.0}) {
          moved.push_back(x);
          moved.back()[i / 3][i % 3] += sign * step;
        }
      const std::vector<Measured> m = measure(kind, moved);
      for (int i = 0; i < 12; ++i)
        ASSERT_NEAR((m[1 + 2 * i].d - m[2 + 2 * i].d) / (2 * step), m[0].c[i / 3] * m[0].n[i % 3], 1e-5);
    }
}

TEST_F(Distances, PointAndTriangleByHand) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  const std::vector<Four> pairs = {{Vec3(1, 1, 2), a, b, c},     // inside
                                   {Vec3(2, -3, 0), a, b, c},    // beyond a side, in the plane
                                   {Vec3(-3, -4, 12), a, b, c},  // beyond a corner: 3-4-12-13
                                   {Vec3(4, 4, 1), a, b, c},     // beyond the long side: middle (2, 2, 0)
                                   {Vec3(1, 1, 0), a, b, c},     // touching
                                   {Vec3(1, 5, 0), a, b, b},     // a triangle that is an edge
                                   {Vec3(3, 4, 0), a, a, a}};    // a triangle that is a point
  const std::vector<Measured> m = measure(POINT_TRIANGLE, pairs);
  const double expected[] = {2, 3, 13, 3, 0, 5, 5};
  for (std::size_t e = 0; e < pairs.size(); ++e) EXPECT_NEAR(m[e].d, expected[e], 1e-14) << e;
  EXPECT_NEAR(m[0].c[1], -0.5, 1e-15);
  EXPECT_NEAR(m[0].c[2], -0.25, 1e-15);
  EXPECT_NEAR(m[0].n[2], 1, 1e-15);
  EXPECT_NEAR(m[2].c[1], -1, 1e-15);
  EXPECT_NEAR(m[3].c[2], -0.5, 1e-15);
}

TEST_F(Distances, TwoEdgesByHand) {
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const std::vector<Four> pairs = {{-x, 3 * x, -2 * y - 3 * z, 2 * y - 3 * z},           // crossing: s 1/4, t 1/2
                                   {Vec3::Zero(), x, 2 * x + y, 2 * x + 3 * y},          // end to end: (1, 1)
                                   {Vec3::Zero(), 4 * x, 2 * x + 5 * y, 2 * x + 9 * y},  // end to edge
                                   {Vec3::Zero(), x, 3 * z, x + 3 * z},                  // parallel, face to face
                                   {Vec3::Zero(), x, 4 * x + 4 * y, 9 * x + 4 * y},      // parallel, apart: 3-4-5
                                   {Vec3::Zero(), x, 3 * x, 7 * x},                      // on one line
                                   {Vec3::Zero(), Vec3::Zero(), 3 * x, 3 * x},           // two points
                                   {-x, x, -y, y}};                                      // touching
  const std::vector<Measured> m = measure(EDGE_EDGE, pairs);
  const double expected[] = {3, std::sqrt(2.0), 5, 3, 5, 2, 3, 0};
  for (std::size_t e = 0; e < pairs.size(); ++e) EXPECT_NEAR(m[e].d, expected[e], 1e-14) << e;
  EXPECT_NEAR(m[0].c[1], 0.25, 1e-15);
  EXPECT_NEAR(m[0].c[3], -0.5, 1e-15);
  EXPECT_NEAR(m[0].n[2], 1, 1e-15);
  EXPECT_NEAR(m[2].c[1], 0.5, 1e-15);
}

TEST_F(Distances, ANumberThatIsNoneStaysNone) {
  Four x = {Vec3(0, 0, 1), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  x[0][0] = NAN;
  EXPECT_TRUE(std::isnan(measure(POINT_TRIANGLE, {x})[0].d));
  EXPECT_TRUE(std::isnan(measure(EDGE_EDGE, {x})[0].d));
}

TEST_F(Distances, OfTheHostAreTheSame) {
  const std::vector<Four> pairs = all_ways(1000);
  const std::vector<Measured> pt = measure(POINT_TRIANGLE, pairs), ee = measure(EDGE_EDGE, pairs);
  for (std::size_t e = 0; e < pairs.size(); ++e) {
    const Four& x = pairs[e];
    ASSERT_NEAR(point_triangle_distance(x[0], x[1], x[2], x[3]), pt[e].d, 2e-9);
    ASSERT_NEAR(edge_edge_distance(x[0], x[1], x[2], x[3]), ee[e].d, 2e-9);
  }
}

}  // namespace
}  // namespace pvg
