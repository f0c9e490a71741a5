// Stitch springs: E = k/2 |x_a - x_b|^2
#include "energies/joint/zero_length_spring.h"

#include "tests/physics/energies/energy_check.hpp"

namespace pvg::zero_length_spring_test {
namespace {

double energy(const ZeroLengthSpring& p, const Vec3* x, const Vec3*, double) {
  return 0.5 * p.stiffness * (x[0] - x[1]).squaredNorm();
}

std::vector<EnergyElement<ZeroLengthSpring>> springs(std::size_t n) {
  Random random(1);
  std::vector<EnergyElement<ZeroLengthSpring>> elements(n);
  for (auto& e : elements) {
    e.params.stiffness = random.number(0, 1e5);
    e.x = {random.vector(0.5), random.vector(0.5)};
    e.x0 = {random.vector(0.5), random.vector(0.5)};
  }
  elements[0].x[1] = elements[0].x[0];
  return elements;
}

TEST(ZeroLengthSpring, EnergyGradientAndHessianAgreeWithTheEnergyInDouble) {
  EnergyCheck<ZeroLengthSpring> check("joint/zero_length_spring", energy, 1e-5);
  check.set_energy_scale(1e-3);
  const auto elements = springs(1000);
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_exact_hessian({elements.begin(), elements.begin() + 50});
  check.expect_symmetric_positive_hessian(elements);
  check.expect_awkward_sizes(elements);
}

TEST(ZeroLengthSpring, PullsBothEndsAlikeAndTurnsNothing) {
  EnergyCheck<ZeroLengthSpring> check("joint/zero_length_spring", energy, 1e-5);
  check.expect_no_net_force(springs(1000));
  check.expect_rotation_invariance(springs(1000));
}

TEST(ZeroLengthSpring, TwoMillimetresAtTenNewtonPerMillimetre) {
  EnergyCheck<ZeroLengthSpring> check("joint/zero_length_spring", energy, 1e-5);
  EnergyElement<ZeroLengthSpring> e;
  e.params.stiffness = 1e4;
  e.x = e.x0 = {Vec3(0.002, 0, 0), Vec3::Zero()};
  const EnergyResult r = check.evaluate({e})[0];
  EXPECT_DOUBLE_EQ(r.energy, 0.02);     // 1e4 N/m (2e-3 m)^2 / 2
  EXPECT_DOUBLE_EQ(r.gradient(0), 20);  // pulled back by 20 N
  EXPECT_DOUBLE_EQ(r.gradient(3), -20);
}

}  // namespace
}  // namespace pvg::zero_length_spring_test
