// Drives of prismatic joints: q = (c_j - c_i) . d_i, and what the drive does along it.
#include "energies/joint/prismatic_drive.h"

#include "tests/physics/energies/joint_check.hpp"

namespace pvg::prismatic_drive_test {
namespace {

using Elements = std::vector<EnergyElement<PrismaticDrive>>;

double coordinate(const PrismaticDrive&, const Vec3* x, const Vec3*) { return (x[1] - x[0]).dot(x[2]); }

double energy(const PrismaticDrive& p, const Vec3* x, const Vec3* x0, double h) {
  return drive_law(p, coordinate(p, x, x0), coordinate(p, x0, x0), h);
}

Elements drives(std::size_t n) {
  Elements elements = prismatic_joints<PrismaticDrive>(n);
  Random random(15);
  for (auto& e : elements) set_random_law(e.params, random, 0.1);
  return elements;
}

TEST(PrismaticDrive, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  EnergyCheck<PrismaticDrive> check("joint/prismatic_drive", energy, 1e-6);
  check.set_energy_scale(1e-2);
  const Elements elements = drives(1000);
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_rotation_invariance(elements);
  check.expect_symmetric_positive_hessian(elements);
  check.expect_awkward_sizes(elements);
}

TEST(PrismaticDrive, HessianIsGaussNewton) {
  EnergyCheck<PrismaticDrive> check("joint/prismatic_drive", energy, 1e-6);
  const Elements elements = drives(500);
  expect_gauss_newton<PrismaticDrive>(
      check, elements, [](const PrismaticDrive& p, const Vec3* x, const Vec3*) { return coordinate(p, x, x); },
      drive_curvature<PrismaticDrive>);
}

// 30 mm out, wanted at 25 mm with 2000 N/m: the child is drawn back by 10 N, the parent forward, cut at 4 N
TEST(PrismaticDrive, DrawsTheChildTowardTheTarget) {
  EnergyCheck<PrismaticDrive> check("joint/prismatic_drive", energy, 1e-6);
  EnergyElement<PrismaticDrive> e;
  e.params.stiffness = 2000;
  e.params.target = 0.025;
  e.x = {Vec3(1, 2, 3), Vec3(1.2, 2.03, 3), Vec3(0, 1, 0)};
  e.x0 = {Vec3(1, 2, 3), Vec3(1.2, 2.029, 3), Vec3(0, 1, 0)};
  EnergyResult r = check.evaluate({e})[0];
  EXPECT_NEAR(r.energy, 0.025, 1e-12);
  EXPECT_NEAR(r.gradient(1), -10, 1e-9);
  EXPECT_NEAR(r.gradient(4), 10, 1e-9);
  e.params.effort_limit = 4;
  EXPECT_NEAR(check.evaluate({e})[0].gradient(4), 4, 1e-9);
  e.params.effort_limit = 0;
  e.params.feed_forward = 3;
  EXPECT_NEAR(check.evaluate({e})[0].gradient(4), 7, 1e-9);
  e.params.damping = 10;  // against 1 mm in 12.5 ms: 0.8 N
  EXPECT_NEAR(check.evaluate({e})[0].gradient(4), 7.8, 1e-9);
}

// With a play of 4 mm the error of 5 mm counts as 3: 6 N; its damping adds 0.8 N, and both are cut at 4 N. There
// k u + b (q - q0) = 4 N at q = 29 mm, from where the energy of 4 mJ goes on as 4 N (q - 29 mm).
TEST(PrismaticDrive, CutsTheDampingOfALooseDrive) {
  EnergyCheck<PrismaticDrive> check("joint/prismatic_drive", energy, 1e-6);
  EnergyElement<PrismaticDrive> e;
  e.params.stiffness = 2000;
  e.params.target = 0.025;
  e.params.play = 0.004;
  e.params.cut_damping = 10;
  e.x = {Vec3(1, 2, 3), Vec3(1.2, 2.03, 3), Vec3(0, 1, 0)};
  e.x0 = {Vec3(1, 2, 3), Vec3(1.2, 2.029, 3), Vec3(0, 1, 0)};
  ASSERT_EQ(check.H, 0.0125);
  EXPECT_NEAR(check.evaluate({e})[0].gradient(4), 6.8, 1e-9);
  e.params.effort_limit = 4;
  const EnergyResult cut = check.evaluate({e})[0];
  EXPECT_NEAR(cut.gradient(4), 4, 1e-9);
  EXPECT_NEAR(cut.energy, 0.004 + 4 * 0.001, 1e-9);
  // inside the play only damping acts: 800 N/m x -3 mm
  e.x[1].y() = 2.026;
  EXPECT_NEAR(check.evaluate({e})[0].gradient(4), -2.4, 1e-9);
  // the slope is the energy's, through play and both limits
  for (double q = 0.018; q < 0.034; q += 0.0007) {
    EnergyElement<PrismaticDrive> low = e, high = e;
    e.x[1].y() = 2 + q;
    low.x[1].y() = 2 + q - 1e-7;
    high.x[1].y() = 2 + q + 1e-7;
    const double slope = (check.evaluate({high})[0].energy - check.evaluate({low})[0].energy) / 2e-7;
    EXPECT_NEAR(check.evaluate({e})[0].gradient(4), slope, 1e-4) << q;
  }
}

}  // namespace
}  // namespace pvg::prismatic_drive_test
