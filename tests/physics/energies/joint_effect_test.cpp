// Friction and springs of joints: V(q) = k q^2 / 2 - P q + c v^2 h / 2 + h R(v), R' = friction
#include "energies/joint/prismatic_effect.h"
#include "energies/joint/revolute_effect.h"
#include "tests/physics/energies/joint_check.hpp"

namespace pvg::joint_effect_test {
namespace {

// friction by its definition [N m]
template <class Params>
double friction(const Params& p, double v) {
  const double y = std::abs(v), w = std::max(y, p.velocity);
  const double smooth = y < p.velocity ? (2 - y / p.velocity) * y / p.velocity : 1;
  return std::copysign((p.coulomb + p.extra * std::exp(-std::pow(w / p.stribeck_velocity, 2))) * smooth, v);
}

// its integral by Simpson's rule in pieces, so that no closed form is repeated
template <class Params>
double power(const Params& p, double v) {
  const auto integrate = [&](double from, double to) {
    const int n = 400;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double a = from + (to - from) * i / n, b = from + (to - from) * (i + 1) / n;
      sum += (b - a) / 6 * (friction(p, a) + 4 * friction(p, 0.5 * (a + b)) + friction(p, b));
    }
    return sum;
  };
  const double y = std::abs(v), eps = p.velocity;
  return y < eps ? integrate(0, y) : integrate(0, eps) + integrate(eps, y);
}

template <class Params>
double law(const Params& p, double q, double q0, double h) {
  const double v = (q - q0) / h;
  return p.stiffness * q * q / 2 - p.preload * q + h * (p.damping * v * v / 2 + power(p, v));
}

template <class Params>
void set_random(Params& p, Random& random) {
  p.stiffness = random.number(0, 100);
  p.preload = random.number(-10, 10);
  p.damping = random.number(0, 5);
  p.coulomb = random.number(0, 5);
  p.extra = random.number(0, 1) < 0.3 ? 0 : random.number(0, 5);
  p.velocity = 2;
  p.stribeck_velocity = random.number(5, 50);
  p.lead = random.number(-0.02, 0.02);
  p.rate_length = random.number(0.005, 0.02);
}

double revolute_energy(const RevoluteEffect& p, const Vec3* x, const Vec3* x0, double) {
  return law(p, host_revolute(x, x0, p.angle0), p.angle0 + p.lead, p.rate_length);
}

double prismatic_coordinate(const Vec3* x) { return (x[1] - x[0]).dot(x[2]); }

double prismatic_energy(const PrismaticEffect& p, const Vec3* x, const Vec3* x0, double) {
  return law(p, prismatic_coordinate(x), prismatic_coordinate(x0) + p.lead, p.rate_length);
}

template <class Params>
void expect_term(EnergyCheck<Params>& check, std::vector<EnergyElement<Params>> elements) {
  Random random(31);
  for (auto& e : elements) set_random(e.params, random);
  check.set_energy_scale(1);
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_symmetric_positive_hessian(elements);
  check.expect_awkward_sizes(elements);
}

TEST(JointEffect, EnergyAndGradientOfRevoluteJointsAgreeWithTheEnergyInDouble) {
  EnergyCheck<RevoluteEffect> check("joint/revolute_effect", revolute_energy, 1e-6);
  expect_term(check, revolute_joints<RevoluteEffect>(1000, 0.1));
}

TEST(JointEffect, EnergyAndGradientOfPrismaticJointsAgreeWithTheEnergyInDouble) {
  EnergyCheck<PrismaticEffect> check("joint/prismatic_effect", prismatic_energy, 1e-7);
  expect_term(check, prismatic_joints<PrismaticEffect>(1000));
}

// friction falls where it slides over the Stribeck effect: zero stands for its curvature there
TEST(JointEffect, CurvatureIsThatOfTheEnergyWithoutWhereFrictionFalls) {
  EnergyCheck<PrismaticEffect> check("joint/prismatic_effect", prismatic_energy, 1e-7);
  auto elements = prismatic_joints<PrismaticEffect>(1000);
  Random random(32);
  for (auto& e : elements) set_random(e.params, random);
  const std::vector<EnergyResult> results = check.evaluate(elements);
  int n_stick = 0, n_slide = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const PrismaticEffect& p = elements[i].params;
    const Vec3 along = elements[i].x[2];  // the child moves along the axis: q changes by its length
    const Eigen::Matrix3d block = results[i].hessian.block<3, 3>(3, 3);
    const double curvature = along.dot(block * along) / std::pow(along.squaredNorm(), 2);
    const double q = prismatic_coordinate(elements[i].x.data()),
                 q0 = prismatic_coordinate(elements[i].x0.data()) + p.lead;
    const double h = p.rate_length, v = (q - q0) / h, step = 1e-6;
    const bool sticks = std::abs(v) < p.velocity;
    if (std::abs(std::abs(v) - p.velocity) < 2 * step) continue;  // between the two
    (sticks ? n_stick : n_slide) += 1;
    const double of_friction = sticks ? (friction(p, v + step) - friction(p, v - step)) / (2 * step) : 0;
    const double expected = p.stiffness + (p.damping + of_friction) / h;
    EXPECT_NEAR(curvature, expected, 1e-5 * expected) << i;
  }
  EXPECT_GT(n_stick, 10);
  EXPECT_GT(n_slide, 10);
}

}  // namespace
}  // namespace pvg::joint_effect_test
