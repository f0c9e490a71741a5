// Contact barrier: E = kappa w m(c) b(d - offset)
#include "energies/contact/barrier.h"

#include "host/geometry/segment_distance.hpp"
#include "tests/physics/energies/energy_check.hpp"

namespace pvg::barrier_test {
namespace {

using Element = EnergyElement<Barrier>;
// nearly parallel edges turn the mollifier fast: the step must be small beside the edge's end times the angle
constexpr double ACTIVATION = 1e-3, STEP = 2e-10;  // [m]

double distance(const Barrier& p, const Vec3* x) {
  return p.kind == POINT_TRIANGLE ? point_triangle_distance(x[0], x[1], x[2], x[3])
                                  : edge_edge_distance(x[0], x[1], x[2], x[3]);
}

double parallelism(const Vec3* x) { return (x[1] - x[0]).cross(x[3] - x[2]).squaredNorm(); }

double mollifier(const Barrier& p, const Vec3* x) {
  const double q = p.kind == EDGE_EDGE ? parallelism(x) / p.mollifier_threshold : 1;
  return q < 1 ? (2 - q) * q : 1;
}

double energy(const Barrier& p, const Vec3* x, const Vec3*, double) {
  const double g = distance(p, x) - p.offset, far = p.activation_distance;
  if (g >= far) return 0;
  const double range = p.adhesion > 0 ? far / 2 : far, s = g / far;
  const double barrier = g < range ? -(g - range) * (g - range) * std::log(g / range) / range : 0;
  return p.area * mollifier(p, x) * (p.stiffness * barrier - p.adhesion * (1 - s) * (1 - s) * (1 + 2 * s));
}

Barrier parameters(u32 kind, Random& random) {
  Barrier p{};
  p.kind = kind;
  p.area = random.number(1e-6, 1e-4);
  p.stiffness = random.number(1e5, 1e8);
  p.activation_distance = ACTIVATION;
  p.offset = random.number(0, 1) < 0.5 ? 0 : random.number(0, 5e-4);
  return p;
}

// a point over a triangle, beyond one of its sides or beyond a corner
Element point_triangle(Random& random) {
  Element e;
  e.params = parameters(POINT_TRIANGLE, random);
  e.x = {Vec3::Zero(), random.vector(0.01), random.vector(0.01), random.vector(0.01)};
  const Vec3 normal = (e.x[2] - e.x[1]).cross(e.x[3] - e.x[1]).normalized();
  const double b0 = random.number(-0.1, 1), b1 = random.number(-0.1, 1 - b0);
  const Vec3 foot = b0 * e.x[1] + b1 * e.x[2] + (1 - b0 - b1) * e.x[3];
  e.x[0] = foot + (e.params.offset + ACTIVATION * random.number(0.1, 1.1)) * normal;
  return e;
}

// edges that cross, or lie one beyond the other's end; angle: largest between them, and ten times the smallest [rad]:
// still smaller ones turn faster than differences can follow
Element edge_edge(Random& random, double angle) {
  Element e;
  e.params = parameters(EDGE_EDGE, random);
  const Vec3 direction = random.vector(1).normalized(), across = direction.cross(random.vector(1)).normalized();
  const Vec3 normal = direction.cross(across);
  const double turn = random.number(0.1 * angle, angle);
  const Vec3 second = std::cos(turn) * direction + std::sin(turn) * across;
  const double length0 = random.number(0.003, 0.01), length1 = random.number(0.003, 0.01);
  const double s = random.number(-0.05, 1.05), t = random.number(-0.05, 1.05);
  const Vec3 lift = (e.params.offset + ACTIVATION * random.number(0.1, 1.1)) * normal;
  e.x = {-s * length0 * direction + lift, (1 - s) * length0 * direction + lift, -t * length1 * second,
         (1 - t) * length1 * second};
  e.params.mollifier_threshold = 1e-3 * length0 * length0 * length1 * length1;
  return e;
}

// pairs deeper than this, or just about to part, need smaller steps than the differences can take
bool is_measurable(const Element& e) {
  const double gap = distance(e.params, e.x.data()) - e.params.offset;
  return gap > 0.08 * ACTIVATION && std::abs(gap - ACTIVATION) > 0.02 * ACTIVATION;
}

enum class Which { point_triangle, edge_edge, parallel };

std::vector<Element> elements(Which which, std::size_t n) {
  Random random(11 + int(which));
  std::vector<Element> found;
  while (found.size() < n) {
    Element e = which == Which::point_triangle ? point_triangle(random)
                                               : edge_edge(random, which == Which::parallel ? 0.03 : 3);
    e.x0 = e.x;
    if (is_measurable(e)) found.push_back(e);
  }
  return found;
}

EnergyCheck<Barrier> make_check() {
  EnergyCheck<Barrier> check("contact/barrier", energy, STEP);
  check.set_energy_scale(1e-6);
  return check;
}

Eigen::VectorXd differences(const std::function<double(const Vec3*)>& f, const Element& element, double step) {
  Eigen::VectorXd gradient(12);
  for (int i = 0; i < 12; ++i) {
    std::vector<Vec3> up = element.x, down = element.x;
    up[i / 3][i % 3] += step;
    down[i / 3][i % 3] -= step;
    gradient[i] = (f(up.data()) - f(down.data())) / (2 * step);
  }
  return gradient;
}

// b'(g) [-] and b''(g) [1/m] by differences of b
struct Slopes {
  double first, second;
};
Slopes slopes(double g) {
  const auto b = [](double gap) {
    const double q = gap - ACTIVATION;
    return gap < ACTIVATION ? -q * q * std::log(gap / ACTIVATION) / ACTIVATION : 0;
  };
  const double step = 1e-3 * g;
  // fourth order
  const double near = (b(g + step) - b(g - step)) / (2 * step), far = (b(g + 2 * step) - b(g - 2 * step)) / (4 * step);
  const double bend = (b(g + step) - 2 * b(g) + b(g - step)) / (step * step);
  const double wide = (b(g + 2 * step) - 2 * b(g) + b(g - 2 * step)) / (4 * step * step);
  return {(4 * near - far) / 3, (4 * bend - wide) / 3};
}

TEST(Barrier, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  EnergyCheck<Barrier> check = make_check();
  for (const Which which : {Which::point_triangle, Which::edge_edge, Which::parallel}) {
    check.expect_energy(elements(which, 1000));
    check.expect_gradient(elements(which, 1000), 1e-5);
  }
}

TEST(Barrier, AttractsWithAdhesion) {
  EnergyCheck<Barrier> check = make_check();
  for (const Which which : {Which::point_triangle, Which::edge_edge, Which::parallel}) {
    std::vector<Element> all = elements(which, 1000);
    Random random(7);
    for (Element& e : all) e.params.adhesion = random.number(10, 1e4);
    check.expect_energy(all);
    check.expect_gradient(all, 1e-5);
    check.expect_symmetric_positive_hessian(all);
  }
}

TEST(Barrier, HessianIsPositiveAndSizesDoNotMatter) {
  EnergyCheck<Barrier> check = make_check();
  for (const Which which : {Which::point_triangle, Which::edge_edge, Which::parallel}) {
    check.expect_symmetric_positive_hessian(elements(which, 1000));
    check.expect_awkward_sizes(elements(which, 1000));
  }
}

TEST(Barrier, ForcesAndTorquesSumToZero) {
  EnergyCheck<Barrier> check = make_check();
  for (const Which which : {Which::point_triangle, Which::edge_edge, Which::parallel}) {
    check.expect_no_net_force(elements(which, 1000));
    check.expect_rotation_invariance(elements(which, 1000));
  }
}

TEST(Barrier, HessianWithoutMollifierIsCurvatureTimesGradientsOfTheDistance) {
  EnergyCheck<Barrier> check = make_check();
  for (const Which which : {Which::point_triangle, Which::edge_edge}) {
    const std::vector<Element> all = elements(which, 300);
    const std::vector<EnergyResult> results = check.evaluate(all);
    int n_checked = 0;
    for (std::size_t e = 0; e < all.size(); ++e) {
      const Barrier& p = all[e].params;
      const double gap = distance(p, all[e].x.data()) - p.offset;
      if (mollifier(p, all[e].x.data()) < 1 || gap > 0.99 * ACTIVATION) continue;
      const Eigen::VectorXd d = differences([&](const Vec3* x) { return distance(p, x); }, all[e], STEP);
      const Eigen::MatrixXd expected = p.stiffness * p.area * slopes(gap).second * d * d.transpose();
      ASSERT_LE((results[e].hessian - expected).cwiseAbs().maxCoeff(), 1e-5 * expected.cwiseAbs().maxCoeff());
      ++n_checked;
    }
    EXPECT_GT(n_checked, 150);
  }
}

// All of the second derivative but the bending of the distance itself, projected over the nine numbers it depends on.
TEST(Barrier, MollifiedHessianHasTheCrossTerms) {
  EnergyCheck<Barrier> check = make_check();
  const std::vector<Element> all = elements(Which::parallel, 300);
  const std::vector<EnergyResult> results = check.evaluate(all);
  int n_checked = 0;
  for (std::size_t e = 0; e < all.size(); ++e) {
    const Barrier& p = all[e].params;
    const Vec3* x = all[e].x.data();
    const double gap = distance(p, x) - p.offset, q = parallelism(x) / p.mollifier_threshold;
    if (q >= 1 || gap > 0.95 * ACTIVATION) continue;
    const double scale = p.stiffness * p.area, b = energy(p, x, x, 0) / scale / mollifier(p, x);
    const double m = (2 - q) * q, m1 = (2 - 2 * q) / p.mollifier_threshold,
                 m2 = -2 / std::pow(p.mollifier_threshold, 2);
    const auto by = [&](const auto& f, const Element& at, double step) { return differences(f, at, step); };
    const Eigen::VectorXd d = by([&](const Vec3* y) { return distance(p, y); }, all[e], STEP);
    // c is a polynomial of degree four in the sites, so wide steps cost nothing but rounding
    const auto c_gradient = [&](const Element& at) {
      return by([](const Vec3* y) { return parallelism(y); }, at, 1e-5);
    };
    const Eigen::VectorXd c = c_gradient(all[e]);
    Eigen::MatrixXd c_hessian(12, 12);
    for (int i = 0; i < 12; ++i) {
      Element up = all[e], down = all[e];
      up.x[i / 3][i % 3] += 1e-5;
      down.x[i / 3][i % 3] -= 1e-5;
      c_hessian.col(i) = (c_gradient(up) - c_gradient(down)) / 2e-5;
    }
    const Eigen::MatrixXd raw = scale * (m * slopes(gap).second * d * d.transpose() +
                                         m1 * slopes(gap).first * (d * c.transpose() + c * d.transpose()) +
                                         b * m2 * c * c.transpose() + b * m1 * c_hessian);
    const double size = raw.cwiseAbs().maxCoeff();
    // over r = x0 - x2, e0, e1 and back: the sites by them (x2 = 0), they by the sites
    Eigen::MatrixXd sites(12, 9), by_sites(9, 12);
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity(), zero = Eigen::Matrix3d::Zero();
    sites << one, zero, zero, one, one, zero, zero, zero, zero, zero, zero, one;
    by_sites << one, zero, -one, zero, -one, one, zero, zero, zero, zero, -one, one;
    const Eigen::MatrixXd reduced = sites.transpose() * raw * sites;
    ASSERT_LE((by_sites.transpose() * reduced * by_sites - raw).cwiseAbs().maxCoeff(), 1e-4 * size) << e;
    const Eigen::MatrixXd expected = by_sites.transpose() * nearest_positive(reduced) * by_sites;
    ASSERT_LE((results[e].hessian - expected).cwiseAbs().maxCoeff(), 1e-4 * size) << e;
    ++n_checked;
  }
  EXPECT_GT(n_checked, 150);
}

// a point 0.5 mm over a triangle, d_hat = 1 mm
TEST(Barrier, HalfTheActivationDistanceByHand) {
  EnergyCheck<Barrier> check = make_check();
  Element e;
  e.params.kind = POINT_TRIANGLE;
  e.params.area = 1e-5;
  e.params.stiffness = 1e7;
  e.params.activation_distance = 1e-3;
  e.x = e.x0 = {Vec3(1e-3, 1e-3, 5e-4), Vec3(0, 0, 0), Vec3(4e-3, 0, 0), Vec3(0, 4e-3, 0)};
  const EnergyResult r = check.evaluate({e})[0];
  EXPECT_NEAR(r.energy, 100 * 0.25e-3 * std::log(2.0), 1e-12);  // kappa w = 100 N
  // b' = -(g - d)(2 ln(g/d) + (g - d)/g)/d = 0.5 (-2 ln 2 - 1) = -1.193147
  EXPECT_NEAR(r.gradient(2), -119.314718056, 1e-6);
  EXPECT_NEAR(r.gradient(5), 119.314718056 / 2, 1e-6);  // half of it on the corner next to the foot
  EXPECT_NEAR(r.gradient(8), 119.314718056 / 4, 1e-6);
  // b'' = (2 ln 2 + 4 + 1)/d = 6386.294 1/m
  EXPECT_NEAR(r.hessian(2, 2), 638629.4361, 1e-3);
}

TEST(Barrier, ParallelEdgesPushNothingAtAll) {
  EnergyCheck<Barrier> check = make_check();
  Element e;
  e.params = elements(Which::parallel, 1)[0].params;
  e.params.offset = 0;
  const Vec3 along(0, 8e-3, 0);
  for (const double shift : {0.0, 2e-3, 8e-3}) {  // face to face, overlapping, end to end
    e.x = e.x0 = {Vec3(0, shift, 4e-4), Vec3(0, shift, 4e-4) + along, Vec3::Zero(), along};
    const EnergyResult r = check.evaluate({e})[0];
    EXPECT_EQ(r.energy, 0);
    EXPECT_EQ(r.gradient.norm(), 0);
    EXPECT_TRUE(r.hessian.allFinite());
  }
}

TEST(Barrier, PenetrationCostsInfinitelyMuchAndDistanceNothing) {
  EnergyCheck<Barrier> check = make_check();
  Element e;
  e.params.kind = POINT_TRIANGLE;
  e.params.area = 1e-5;
  e.params.stiffness = 1e7;
  e.params.activation_distance = 1e-3;
  e.params.offset = 2e-3;
  const std::vector<Vec3> triangle = {Vec3(0, 0, 0), Vec3(4e-3, 0, 0), Vec3(0, 4e-3, 0)};
  const auto energy_at = [&](double z) {
    e.x = {Vec3(1e-3, 1e-3, z), triangle[0], triangle[1], triangle[2]};
    e.x0 = e.x;
    return check.evaluate({e})[0].energy;
  };
  EXPECT_EQ(energy_at(3e-3), 0);
  EXPECT_GT(energy_at(2.9e-3), 0);
  EXPECT_TRUE(std::isinf(energy_at(2e-3)));
  EXPECT_TRUE(std::isinf(energy_at(1e-3)));
  EXPECT_TRUE(std::isinf(energy_at(0)));
  EXPECT_TRUE(std::isinf(energy_at(NAN)));
}

}  // namespace
}  // namespace pvg::barrier_test
