// Force and drag at a point: E = -F . d + c |d|^2 / (2 h) + k |d|^3 / (3 h^2)
#include "energies/body/point_force.h"

#include "tests/physics/energies/energy_check.hpp"

namespace pvg::point_force_test {
namespace {

using Elements = std::vector<EnergyElement<PointForce>>;

double energy(const PointForce& p, const Vec3* x, const Vec3* x0, double h) {
  const Vec3 v = (x[0] - x0[0]) / h;
  return -Eigen::Map<const Vec3>(p.force).dot(h * v) +
         h * (p.linear * v.squaredNorm() / 2 + p.quadratic * std::pow(v.norm(), 3) / 3);
}

Elements forces(std::size_t n) {
  Random random(21);
  Elements elements(n);
  for (auto& e : elements) {
    Eigen::Map<Vec3>(e.params.force) = random.vector(10);
    e.params.linear = random.number(0, 5);
    e.params.quadratic = random.number(0, 5);
    e.x0 = {random.vector(0.5)};
    e.x = {e.x0[0] + random.vector(0.05)};
  }
  elements[0].x = elements[0].x0;
  return elements;
}

TEST(PointForce, EnergyGradientAndHessianAgreeWithTheEnergyInDouble) {
  EnergyCheck<PointForce> check("body/point_force", energy, 1e-6);
  check.set_energy_scale(1e-3);
  const Elements elements = forces(1000);
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_exact_hessian({elements.begin() + 1, elements.begin() + 50});
  check.expect_symmetric_positive_hessian(elements);
  check.expect_awkward_sizes(elements);
}

// 2 m/s: 3 N s/m x 2 m/s + 0.5 N s^2/m^2 x 4 m^2/s^2 = 8 N against the motion
TEST(PointForce, EightNewtonAtTwoMetresPerSecond) {
  EnergyCheck<PointForce> check("body/point_force", energy, 1e-6);
  EnergyElement<PointForce> e;
  e.params.linear = 3;
  e.params.quadratic = 0.5;
  e.x0 = {Vec3::Zero()};
  e.x = {Vec3(0, 2 * check.H, 0)};
  EXPECT_NEAR(check.evaluate({e})[0].gradient(1), 8, 1e-12);
}

}  // namespace
}  // namespace pvg::point_force_test
