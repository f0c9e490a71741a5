// What brakes the turning of a rigid body: E = c y^2 / (2 h) + T f0(y), y = |omega| h
#include "energies/body/spin.h"

#include "tests/physics/energies/energy_check.hpp"

namespace pvg::spin_test {
namespace {

using Elements = std::vector<EnergyElement<Spin>>;

double energy(const Spin& p, const Vec3* x, const Vec3* x0, double h) {
  double square = 0;
  for (int k = 0; k < 3; ++k) square += (x[k] - x0[k]).squaredNorm() / 2;
  const double y = std::sqrt(square), eps = p.velocity * h;
  const double f0 = y < eps ? -y * y * y / (3 * eps * eps) + y * y / eps + eps / 3 : y;
  return p.drag * y * y / (2 * h) + (p.torque > 0 ? p.torque * f0 : 0);
}

Elements spins(std::size_t n, double turn) {
  Random random(22);
  Elements elements(n);
  for (auto& e : elements) {
    e.params.drag = random.number(0, 1);
    e.params.torque = random.number(0, 1) < 0.3 ? 0 : random.number(0, 5);
    e.params.velocity = 1;
    const Eigen::Matrix3d axes = random.rotation();
    for (int k = 0; k < 3; ++k) {
      e.x0.push_back(axes.col(k));
      e.x.push_back(axes.col(k) + random.vector(turn));
    }
  }
  return elements;
}

TEST(Spin, EnergyGradientAndHessianAgreeWithTheEnergyInDouble) {
  EnergyCheck<Spin> check("body/spin", energy, 1e-7);
  check.set_energy_scale(1e-3);
  for (const double turn : {2e-3, 0.1}) {  // below and above where the torque is fully developed
    const Elements elements = spins(1000, turn);
    check.expect_energy(elements);
    check.expect_gradient(elements);
    check.expect_exact_hessian({elements.begin(), elements.begin() + 50}, 1e-5);
    check.expect_symmetric_positive_hessian(elements);
    check.expect_awkward_sizes(elements);
  }
}

// the axes turned by 0.001 rad in 0.0125 s, 0.08 rad/s: the virtual power of the torque is -(2 x 0.08 + 0.3) w
TEST(Spin, TorqueOfATurningBody) {
  EnergyCheck<Spin> check("body/spin", energy, 1e-7);
  EnergyElement<Spin> e;
  e.params = {{}, 0, 2, 0.3, 1e-4, 0};
  const double angle = 1e-3;
  const Vec3 axis = Vec3(1, 2, 2) / 3;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  for (int k = 0; k < 3; ++k) {
    e.x0.push_back(Vec3::Unit(k));
    e.x.push_back(turn.col(k));
  }
  const Eigen::VectorXd g = check.evaluate({e})[0].gradient;
  double torque = 0;
  for (int k = 0; k < 3; ++k) torque += g.segment<3>(3 * k).dot(axis.cross(e.x[k]));
  EXPECT_NEAR(torque, 2 * 0.08 + 0.3, 1e-6);
}

}  // namespace
}  // namespace pvg::spin_test
