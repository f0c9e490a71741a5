// Additive continuous collision detection against checks that share nothing with it: an interval bisection with a bound
// on the speed, and the roots of the coplanarity polynomial, both in extended precision.
#include "host/physics/contact/continuous_collision.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "host/geometry/mesh.hpp"

namespace pvg {
namespace {

using Real = long double;
using Vec = Eigen::Matrix<Real, 3, 1>;

struct Motion {
  u32 kind = POINT_TRIANGLE;
  std::array<Vec3, 4> x0, x1;
  double offset = 0;
  double hit = -1;  // a time at which they are known to touch; -1: not known
  Vec at(int i, Real t) const { return x0[i].cast<Real>() + t * (x1[i].cast<Real>() - x0[i].cast<Real>()); }
};

Real point_segment(const Vec& p, const Vec& a, const Vec& b) {
  const Vec e = b - a;
  const Real ee = e.squaredNorm();
  const Real s = ee > 0 ? std::clamp<Real>((p - a).dot(e) / ee, 0, 1) : 0;
  return (a + s * e - p).norm();
}

// the gap at time t, by trying every kind of closest pair
Real gap(const Motion& m, Real t) {
  const Vec a = m.at(0, t), b = m.at(1, t), c = m.at(2, t), d = m.at(3, t);
  if (m.kind == POINT_TRIANGLE) {
    const Real border = std::min({point_segment(a, b, c), point_segment(a, c, d), point_segment(a, d, b)});
    const Vec n = (c - b).cross(d - b);
    const auto side = [&](const Vec& p, const Vec& q) { return (q - p).cross(a - p).dot(n); };
    const bool is_inside = n.norm() > 0 && side(b, c) > 0 && side(c, d) > 0 && side(d, b) > 0;
    return (is_inside ? std::min(border, std::abs((a - b).dot(n)) / n.norm()) : border) - m.offset;
  }
  const Real ends =
      std::min({point_segment(a, c, d), point_segment(b, c, d), point_segment(c, a, b), point_segment(d, a, b)});
  const Vec e0 = b - a, e1 = d - c, r = c - a, n = e0.cross(e1);
  const Real nn = n.squaredNorm();
  if (!(nn > 0)) return ends - m.offset;
  const Real s = r.cross(e1).dot(n) / nn, u = r.cross(e0).dot(n) / nn;
  const bool is_inside = s > 0 && s < 1 && u > 0 && u < 1;
  return (is_inside ? std::min(ends, std::abs(r.dot(n)) / std::sqrt(nn)) : ends) - m.offset;
}

// no faster than this can the gap change [m per unit of t]
Real closing_speed(const Motion& m) {
  Vec v[4], mean = Vec::Zero();
  for (int i = 0; i < 4; ++i) mean += v[i] = m.at(i, 1) - m.at(i, 0);
  Real speed[4];
  for (int i = 0; i < 4; ++i) speed[i] = (v[i] - mean / 4).norm();
  return m.kind == POINT_TRIANGLE ? speed[0] + std::max({speed[1], speed[2], speed[3]})
                                  : std::max(speed[0], speed[1]) + std::max(speed[2], speed[3]);
}

// Coefficients of det [x1 - x0, x2 - x0, x3 - x0](t) in quadruple precision: at a contact without offset it vanishes.
using Quad = __float128;
using Cubic = std::array<Quad, 4>;
Cubic coplanarity(const Motion& m) {
  Quad p[3][3], v[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      p[i][k] = Quad(m.x0[i + 1][k]) - Quad(m.x0[0][k]);
      v[i][k] = Quad(m.x1[i + 1][k]) - Quad(m.x1[0][k]) - p[i][k];
    }
  Cubic c = {0, 0, 0, 0};
  for (int mask = 0; mask < 8; ++mask) {
    Quad row[3][3];
    int degree = 0;
    for (int i = 0; i < 3; ++i) {
      degree += mask >> i & 1;
      for (int k = 0; k < 3; ++k) row[i][k] = mask >> i & 1 ? v[i][k] : p[i][k];
    }
    Quad det = 0;
    for (int k = 0; k < 3; ++k)
      det += row[0][k] * (row[1][(k + 1) % 3] * row[2][(k + 2) % 3] - row[1][(k + 2) % 3] * row[2][(k + 1) % 3]);
    c[degree] += det;
  }
  return c;
}

// Bernstein coefficients on [low, high] of one sign: no root there
bool has_no_root(const Cubic& c, Real low, Real high) {
  const Quad t = low, w = Quad(high) - t;
  const Quad a0 = c[0] + t * (c[1] + t * (c[2] + t * c[3])), a1 = w * (c[1] + t * (2 * c[2] + 3 * t * c[3])),
             a2 = w * w * (c[2] + 3 * t * c[3]), a3 = w * w * w * c[3];
  const Quad b[4] = {a0, a0 + a1 / 3, a0 + 2 * a1 / 3 + a2 / 3, a0 + a1 + a2 + a3};
  const auto all = [&](int sign) { return std::all_of(b, b + 4, [&](Quad q) { return q * sign > 0; }); };
  return all(1) || all(-1);
}

enum class Answer { apart, touching, undecided };

// Is the gap larger than `least` all the way from t = low to high? By bisection: yes for an interval where the speed is
// too small to use up the gap in its middle, or in which the points never lie in one plane.
struct Bisection {
  const Motion& m;
  Real least, speed;
  Cubic cubic;
  int budget;

  Answer operator()(Real low, Real high) {
    if (--budget < 0) return Answer::undecided;
    const Real middle = (low + high) / 2, at_middle = gap(m, middle);
    if (at_middle <= least) return Answer::touching;
    if (at_middle - least > speed * (high - low) / 2) return Answer::apart;
    if (m.offset == 0 && least == 0 && has_no_root(cubic, low, high)) return Answer::apart;
    const Answer left = (*this)(low, middle);
    return left == Answer::apart ? (*this)(middle, high) : left;
  }
};

Answer stays_apart(const Motion& m, Real high, Real least, int budget) {
  return Bisection{m, least, closing_speed(m), coplanarity(m), budget}(0, high);
}

class Motions {
 public:
  explicit Motions(unsigned seed) : engine_(seed) {}
  double number(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  double magnitude(double low, double high) { return std::pow(10, number(low, high)); }
  Vec3 vector(double size = 1) { return size * Vec3(number(-1, 1), number(-1, 1), number(-1, 1)); }

  // four points 1 cm apart that move by up to `speed`
  Motion any(double speed = 0.02) {
    Motion m;
    m.kind = engine_() % 2;
    for (int i = 0; i < 4; ++i) {
      m.x0[i] = vector(0.01);
      m.x1[i] = m.x0[i] + vector(speed);
    }
    return m;
  }

  // a point of the first primitive meets one of the second at t = hit
  Motion aimed(double speed) {
    Motion m = any(speed);
    m.hit = number(0.01, 0.99);
    const bool is_edge = m.kind == EDGE_EDGE;
    const double s = number(0, 1), u = number(0, 1), v = number(0, 1 - u);
    const auto meeting = [&](const std::array<Vec3, 4>& x) -> Vec3 {
      return is_edge ? Vec3((1 - s) * x[0] + s * x[1] - (1 - u) * x[2] - u * x[3])
                     : Vec3(x[0] - u * x[1] - v * x[2] - (1 - u - v) * x[3]);
    };
    // move the first primitive's target so that the difference vanishes there
    const Vec3 at_hit = (1 - m.hit) * meeting(m.x0) + m.hit * meeting(m.x1);
    for (int i = 0; i < (is_edge ? 2 : 1); ++i) m.x1[i] -= at_hit / m.hit;
    return m;
  }

  // flat things that glide along each other at a constant gap
  Motion sliding(double gap, double speed) {
    Motion m = any(0);
    const Vec3 along = Vec3(number(-1, 1), number(-1, 1), 0) * speed;
    for (int i = 0; i < 4; ++i) {
      const bool is_first = m.kind == EDGE_EDGE ? i < 2 : i < 1;
      m.x0[i][2] = is_first ? gap : 0;
      m.x1[i] = m.x0[i];
      if (is_first) m.x1[i] += along;
    }
    return m;
  }

  Motion parallel_edges(double angle, double gap, double speed) {
    Motion m;
    m.kind = EDGE_EDGE;
    const double shift = number(-0.008, 0.008);
    m.x0 = {Vec3(shift, 0, gap), Vec3(shift + 0.01, 0.01 * angle, gap), Vec3(0, 0, 0), Vec3(0.01, 0, 0)};
    m.x1 = m.x0;
    for (int i = 0; i < 2; ++i) m.x1[i] += Vec3(number(-1, 1) * speed, number(-1, 1) * speed, -number(0, 2) * gap);
    return m;
  }

 private:
  std::mt19937 engine_;
};

Motion motion_of_family(Motions& random, int family) {
  Motion m;
  switch (family) {
    case 0:
      return random.any();
    case 1:
      return random.any(random.magnitude(-3, 1));
    case 2:
      return random.aimed(0.02);
    case 3:
      return random.aimed(1e4);  // huge speeds
    case 4:
      return random.sliding(random.magnitude(-9, -3), 0.02);  // tiny gaps
    case 5:
      return random.sliding(random.magnitude(-9, -3), random.magnitude(0, 4));
    case 6:
      return random.parallel_edges(0, random.magnitude(-9, -3), 0.01);  // parallel
    case 7:
      return random.parallel_edges(random.magnitude(-9, -1), random.magnitude(-9, -3), 0.01);
    case 8:  // head on from a tiny gap
      m = random.sliding(random.magnitude(-9, -4), 0);
      for (int i = 0; i < (m.kind == EDGE_EDGE ? 2 : 1); ++i) m.x1[i][2] -= random.number(0.5, 3) * m.x0[i][2];
      return m;
    case 9:  // an edge or a triangle that is a point
      m = random.aimed(0.02);
      m.x0[3] = m.x0[2], m.x1[3] = m.x1[2], m.hit = -1;
      return m;
    case 10:  // needles
      m = random.aimed(0.02);
      m.x0[3] = m.x0[1] + 0.4 * (m.x0[2] - m.x0[1]) + random.vector(1e-12), m.hit = -1;
      return m;
    case 11:  // everything flies together
      m = random.any(0.01);
      for (int i = 0; i < 4; ++i) m.x1[i] += Vec3(1e3, -2e3, 500);
      return m;
    case 12:  // with offsets
      m = random.aimed(0.02);
      m.offset = random.magnitude(-4, -2);
      return m;
    case 13:  // gliding just outside the offset
      m = random.sliding(1e-3 + random.magnitude(-6, -4), 0.01);
      m.offset = 1e-3;
      return m;
    case 14: {  // passing each other narrowly
      m = random.aimed(0.02);
      const Vec3 aside = random.vector(random.magnitude(-7, -3));
      for (int i = 0; i < (m.kind == EDGE_EDGE ? 2 : 1); ++i) m.x1[i] += aside;
      m.hit = -1;
      return m;
    }
    default:  // turning over
      m = random.any(0);
      for (int i = 0; i < 4; ++i) m.x1[i] = -m.x0[(i + 1) % 4];
      return m;
  }
}
constexpr int N_FAMILIES = 16, N_EACH = 800;

class AdditiveCollision : public ::testing::Test {
 protected:
  std::vector<double> steps(const std::vector<Motion>& motions) {
    std::vector<Barrier> rows(motions.size());
    std::vector<double> x0, x1;
    for (u32 e = 0; e < motions.size(); ++e) {
      rows[e].kind = motions[e].kind;
      rows[e].offset = motions[e].offset;
      for (u32 i = 0; i < 4; ++i) {
        rows[e].site[i] = 4 * e + i;
        x0.insert(x0.end(), motions[e].x0[i].begin(), motions[e].x0[i].end());
        x1.insert(x1.end(), motions[e].x1[i].begin(), motions[e].x1[i].end());
      }
    }
    const WorldRows<Barrier> pairs{Buffer<Barrier>(device_, rows, "pairs"), {0, u32(rows.size())}};
    const Buffer<double> begin(device_, x0, "x0"), end(device_, x1, "x1");
    least_ = collision_.largest_step(pairs, begin, end)[0];
    return collision_.start(pairs, begin, end).read();
  }

  Device device_;
  ContinuousCollision collision_{device_};
  double least_ = 0;
};

TEST_F(AdditiveCollision, MissesNoCollisionInTwelveThousandMotions) {
  Motions random(23);
  std::vector<Motion> motions;
  const bool is_simulated = std::getenv("PVG_OCLGRIND");  // a thousand times slower
  const int n = is_simulated ? N_FAMILIES : N_FAMILIES * N_EACH;
  for (int i = 0; i < n; ++i) motions.push_back(motion_of_family(random, i % N_FAMILIES));
  const std::vector<double> found = steps(motions);
  int n_undecided = 0, n_cut = 0, n_hit = 0;
  for (std::size_t e = 0; e < motions.size(); ++e) {
    const Motion& m = motions[e];
    const double step = found[e];
    SCOPED_TRACE("family " + std::to_string(e % N_FAMILIES) + " case " + std::to_string(e));
    ASSERT_GE(step, 0);
    ASSERT_LE(step, 1);
    const Real start = gap(m, 0);
    if (start <= 0) {
      ASSERT_EQ(step, 0);
      continue;
    }
    if (m.hit >= 0) {
      ASSERT_LT(step, m.hit);
      ++n_hit;
    }
    const Answer answer = stays_apart(m, step, 0, 20000);
    ASSERT_NE(answer, Answer::touching) << "step " << step;
    n_undecided += answer == Answer::undecided;
    n_cut += step < 1;
    // timid would be: to stop although the gap never falls to a tenth of what it was
    ASSERT_TRUE(step == 1 || stays_apart(m, 1, 0.11 * start, 2000) != Answer::apart) << "step " << step;
  }
  EXPECT_LE(n_undecided, N_EACH / 10);  // edges that stay parallel at 1e-9 m are always in one plane
  if (!is_simulated) {
    EXPECT_GT(n_hit, 2000);
    EXPECT_GT(n_cut, 4000);
  }
  EXPECT_EQ(least_, *std::min_element(found.begin(), found.end()));
}

TEST_F(AdditiveCollision, GlidingFaceToFaceIsNotHeldUp) {
  Motions random(5);
  std::vector<Motion> motions;
  while (motions.size() < 1000) {
    const double z = random.magnitude(-9, -3);
    const Motion m = random.sliding(z, random.magnitude(-2, 4));
    if (gap(m, 0) < 2 * z) motions.push_back(m);
  }
  for (const double step : steps(motions)) ASSERT_EQ(step, 1);
}

TEST_F(AdditiveCollision, HeadOnStopsBetweenNineTenthsAndTheWholeWay) {
  Motions random(6);
  std::vector<Motion> motions;
  for (int i = 0; i < 1000; ++i) {
    Motion m = random.sliding(1e-3, 0);
    // the point over the middle of the triangle, edges crossing in their middles; down by 2 mm
    if (m.kind == POINT_TRIANGLE) {
      m.x0[0] = (m.x0[1] + m.x0[2] + m.x0[3]) / 3 + Vec3(0, 0, 1e-3);
    } else {
      const Vec3 shift = (m.x0[2] + m.x0[3] - m.x0[0] - m.x0[1]) / 2 + Vec3(0, 0, 1e-3);
      m.x0[0] += shift, m.x0[1] += shift;
    }
    m.x1 = m.x0;
    for (int k = 0; k < (m.kind == EDGE_EDGE ? 2 : 1); ++k) m.x1[k][2] -= 2e-3;
    motions.push_back(m);
  }
  for (const double step : steps(motions)) {
    ASSERT_GE(step, 0.9 * 0.5 - 1e-12);
    ASSERT_LT(step, 0.5);
  }
}

TEST_F(AdditiveCollision, TouchingAndWorseGiveZeroAndNoMotionGivesOne) {
  Motion still;
  still.x0 = still.x1 = {Vec3(0.2, 0.2, 1), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  Motion touching = still, inside_offset = still, leaving = still, nowhere = still;
  touching.x0[0][2] = 0;  // to rounding
  inside_offset.offset = 1;
  leaving.x1[0][2] = 1e4;
  nowhere.x1[0][2] = NAN;
  EXPECT_EQ(steps({still, touching, inside_offset, leaving, nowhere}), (std::vector<double>{1, 0, 0, 1, 0}));
}

TEST_F(AdditiveCollision, EachWorldHasItsOwnMinimum) {
  WorldMinimum minimum(device_);
  Motions random(9);
  for (const std::size_t n : {0, 1, 3, 257, 1000}) {
    std::vector<double> values(n);
    for (double& value : values) value = random.number(0, 1);
    const Buffer<double> on_device(device_, values, "values");
    const u32 a = u32(n / 3), b = u32(n / 2);
    const std::vector<u32> first = {0, a, a, b, u32(n)};
    const std::vector<double> found = minimum(first, on_device, 7.0);
    for (int w = 0; w < 4; ++w) {
      double least = 7;
      for (u32 i = first[w]; i < first[w + 1]; ++i) least = std::min(least, values[i]);
      EXPECT_EQ(found[w], least) << "world " << w << " of " << n;
    }
  }
}

}  // namespace
}  // namespace pvg
