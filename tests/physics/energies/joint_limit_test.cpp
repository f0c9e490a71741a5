// Stops of revolute and prismatic joints: E = k/2 (q - limit)^2 beyond the limit, nothing inside.
#include "energies/joint/prismatic_limit.h"
#include "energies/joint/revolute_limit.h"
#include "tests/physics/energies/joint_check.hpp"

namespace pvg::joint_limit_test {
namespace {

template <class Params>
double stop_law(const Params& p, double q, double, double) {
  if (q > p.upper) return p.stiffness / 2 * std::pow(q - p.upper, 2);
  return q < p.lower ? p.stiffness / 2 * std::pow(p.lower - q, 2) : 0;
}

template <class Params>
double stop_curvature(const Params& p, double q, double) {
  return q > p.upper || q < p.lower ? p.stiffness : 0;
}

double revolute_coordinate(const RevoluteLimit& p, const Vec3* x, const Vec3* x0) {
  return host_revolute(x, x0, p.angle0);
}
double prismatic_coordinate(const PrismaticLimit&, const Vec3* x, const Vec3*) { return (x[1] - x[0]).dot(x[2]); }

double revolute_energy(const RevoluteLimit& p, const Vec3* x, const Vec3* x0, double h) {
  return stop_law(p, revolute_coordinate(p, x, x0), 0, h);
}
double prismatic_energy(const PrismaticLimit& p, const Vec3* x, const Vec3* x0, double h) {
  return stop_law(p, prismatic_coordinate(p, x, x0), 0, h);
}

template <class Params>
void set_random_stops(std::vector<EnergyElement<Params>>& elements, double range) {
  Random random(16);
  for (auto& e : elements) {
    e.params.stiffness = random.number(10, 1e5);
    e.params.lower = random.number(-range, 0);
    e.params.upper = random.number(0, range);
  }
}

TEST(RevoluteLimit, AgreesWithTheEnergyInDouble) {
  EnergyCheck<RevoluteLimit> check("joint/revolute_limit", revolute_energy, 1e-6);
  check.set_energy_scale(1);
  auto elements = revolute_joints<RevoluteLimit>(1000, 0.1);
  set_random_stops(elements, 10);
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_rotation_invariance(elements);
  check.expect_symmetric_positive_hessian(elements);
  check.expect_awkward_sizes(elements);
  expect_gauss_newton<RevoluteLimit>(check, elements, revolute_coordinate, stop_curvature<RevoluteLimit>);
}

TEST(PrismaticLimit, AgreesWithTheEnergyInDouble) {
  EnergyCheck<PrismaticLimit> check("joint/prismatic_limit", prismatic_energy, 1e-6);
  check.set_energy_scale(1e-2);
  auto elements = prismatic_joints<PrismaticLimit>(1000);
  set_random_stops(elements, 0.1);
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_rotation_invariance(elements);
  check.expect_symmetric_positive_hessian(elements);
  check.expect_awkward_sizes(elements);
  expect_gauss_newton<PrismaticLimit>(check, elements, prismatic_coordinate, stop_curvature<PrismaticLimit>);
}

// 1 mm beyond the upper stop, then 2 mm beyond the lower one, then between them
TEST(PrismaticLimit, ActsBeyondItsStopsOnly) {
  EnergyCheck<PrismaticLimit> check("joint/prismatic_limit", prismatic_energy, 1e-6);
  EnergyElement<PrismaticLimit> e;
  e.params.stiffness = 1e4;
  e.params.lower = -0.01;
  e.params.upper = 0.04;
  const auto force_at = [&](double q) {
    e.x = e.x0 = {Vec3::Zero(), Vec3(q, 0.1, 0), Vec3::UnitX()};
    return -check.evaluate({e})[0].gradient(3);
  };
  EXPECT_NEAR(force_at(0.041), -10, 1e-9);
  EXPECT_NEAR(force_at(-0.012), 20, 1e-9);
  EXPECT_EQ(force_at(0.04), 0);
  EXPECT_EQ(force_at(0.0), 0);
}

}  // namespace
}  // namespace pvg::joint_limit_test
