// Drives of revolute joints: the angle of four directions, and what the drive does along it.
#include "energies/joint/revolute_drive.h"

#include "tests/physics/energies/joint_check.hpp"

namespace pvg::revolute_drive_test {
namespace {

using Elements = std::vector<EnergyElement<RevoluteDrive>>;

double energy(const RevoluteDrive& p, const Vec3* x, const Vec3* x0, double h) {
  return drive_law(p, host_revolute(x, x0, p.angle0), p.angle0, h);
}

Elements drives(std::size_t n, double noise = 0.1) {
  Elements elements = revolute_joints<RevoluteDrive>(n, noise);
  Random random(13);
  for (auto& e : elements) set_random_law(e.params, random, 10);
  return elements;
}

struct RevoluteDriveTest : testing::Test {
  EnergyCheck<RevoluteDrive> check{"joint/revolute_drive", energy, 1e-6};
  RevoluteDriveTest() { check.set_energy_scale(1); }

  // one drive without damping, its child turned by `turned` since the start of the step
  EnergyElement<RevoluteDrive> turned_by(double angle0, double turned) {
    Random random(14);
    EnergyElement<RevoluteDrive> e;
    e.params.angle0 = angle0;
    e.x0 = revolute_sites(random, angle0);
    Random same(14);
    e.x = revolute_sites(same, angle0 + turned);
    return e;
  }
};

TEST_F(RevoluteDriveTest, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  const Elements elements = drives(1000);
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_rotation_invariance(elements);
  check.expect_symmetric_positive_hessian(elements);
  check.expect_awkward_sizes(elements);
}

TEST_F(RevoluteDriveTest, HessianIsGaussNewton) {
  expect_gauss_newton<RevoluteDrive>(
      check, drives(500),
      [](const RevoluteDrive& p, const Vec3* x, const Vec3* x0) { return host_revolute(x, x0, p.angle0); },
      drive_curvature<RevoluteDrive>);
}

// right-handed about axis = n x b, whole turns kept: q = 7.3 + 1.2 for a target of 8
TEST_F(RevoluteDriveTest, CountsWholeTurnsByTheRightHand) {
  auto e = turned_by(7.3, 1.2);
  e.params.stiffness = 100;
  e.params.target = 8;
  EXPECT_NEAR(check.evaluate({e})[0].energy, 12.5, 1e-10);  // 100 N m/rad (0.5 rad)^2 / 2
  e = turned_by(-9, -2.5);
  e.params.stiffness = 100;
  e.params.target = -11;
  EXPECT_NEAR(check.evaluate({e})[0].energy, 12.5, 1e-10);
}

// the work of the forces on a small turn of the child is minus the effort: here k (target - q) = -50 N m
TEST_F(RevoluteDriveTest, TurnsTheChildTowardTheTarget) {
  auto e = turned_by(0.2, 0.3);
  e.params.stiffness = 100;
  e.params.target = 0;
  const Vec3 axis = e.x[0].cross(e.x[1]);
  const auto effort = [&] {
    const Eigen::VectorXd g = check.evaluate({e})[0].gradient;
    return -(g.segment<3>(6).dot(axis.cross(e.x[2])) + g.segment<3>(9).dot(axis.cross(e.x[3])));
  };
  EXPECT_NEAR(effort(), -50, 1e-9);
  e.params.feed_forward = 20;
  EXPECT_NEAR(effort(), -30, 1e-9);
  e.params.effort_limit = 12;
  EXPECT_NEAR(effort(), -12, 1e-9);
  e.params.stiffness = 0;
  EXPECT_NEAR(effort(), 12, 1e-9);
  e.params.effort_limit = 0;
  e.params.damping = 2;  // against (0.3 - 0.05) rad in 0.0125 s: 40 N m
  e.params.target_change = 0.05;
  EXPECT_NEAR(effort(), 20 - 40, 1e-9);
}

}  // namespace
}  // namespace pvg::revolute_drive_test
