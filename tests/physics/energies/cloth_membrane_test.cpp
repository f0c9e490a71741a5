// Woven membrane:  E = A (k_u phi(e_u) + k_v phi(e_v) + k_p e_u e_v + k_s/2 (f_u . f_v)^2),
//   e = |f| - 1,  phi(e) = e^2/2 + S max(e - e_l, 0)^3
#include "energies/elastic/cloth_membrane.h"
#include "tests/physics/energies/energy_check.hpp"

namespace pvg::cloth_membrane_test {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Deformation = Eigen::Matrix<double, 3, 2>;

double phi(const ClothMembrane& p, double e) {
  return e * e / 2 + p.stiffening * std::pow(std::max(e - p.limit_strain, 0.0), 3);
}

// the two energies per area: of the fibres, of their angle
double part(const ClothMembrane& p, int which, const Deformation& F) {
  if (which == 1) return p.shear / 2 * std::pow(F.col(0).dot(F.col(1)), 2);
  const double warp = F.col(0).norm() - 1, weft = F.col(1).norm() - 1;
  return p.stretch_warp * phi(p, warp) + p.stretch_weft * phi(p, weft) + p.coupling * warp * weft;
}

Deformation deformation(const ClothMembrane& p, const Vec3* x) {
  Deformation sides;
  sides << x[1] - x[0], x[2] - x[0];
  return sides * Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(p.rest_inverse);
}

double energy(const ClothMembrane& p, const Vec3* x, const Vec3*, double) {
  const Deformation F = deformation(p, x);
  return p.area * (part(p, 0, F) + part(p, 1, F));
}

using Element = EnergyElement<ClothMembrane>;

// a triangle of about 10 mm with fibres at any angle, at rest in the plane z = 0
Element rest_element(Random& random) {
  Element e;
  Eigen::Vector2d corner[3] = {{0, 0}, {0.01, 0}, {0, 0.01}};
  const Matrix2d turn = Eigen::Rotation2Dd(random.number(-3, 3)).toRotationMatrix();
  for (auto& c : corner) c = turn * (c + 0.002 * Eigen::Vector2d(random.number(-1, 1), random.number(-1, 1)));
  Matrix2d sides;
  sides << corner[1] - corner[0], corner[2] - corner[0];
  const Matrix2d inverse = sides.inverse();
  for (int k = 0; k < 4; ++k) e.params.rest_inverse[k] = inverse(k / 2, k % 2);
  e.params.area = sides.determinant() / 2;
  e.params.stretch_warp = random.number(500, 5000);
  e.params.stretch_weft = random.number(500, 5000);
  e.params.coupling = random.number(0, 0.9) * std::sqrt(e.params.stretch_warp * e.params.stretch_weft);
  e.params.shear = random.number(20, 1000);
  e.params.limit_strain = 0.03;
  e.params.stiffening = 100;
  for (const auto& c : corner) e.x.push_back(Vec3(c.x(), c.y(), 0));
  e.x0 = e.x;
  return e;
}

// turned, sheared and with strains from -amount to amount
std::vector<Element> elements(std::size_t n, double amount) {
  Random random(3);
  std::vector<Element> list;
  for (std::size_t i = 0; i < n; ++i) {
    list.push_back(rest_element(random));
    const Eigen::Matrix3d turn = random.rotation();
    Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b) stretch(a, b) += random.number(-amount, amount);
    const Vec3 shift = random.vector(0.05);
    for (Vec3& x : list.back().x) x = turn * stretch * x + shift;
  }
  return list;
}

struct ClothMembraneTest : testing::Test {
  EnergyCheck<ClothMembrane> check{"elastic/cloth_membrane", energy, 1e-8};
  ClothMembraneTest() { check.set_energy_scale(1e-6); }
};

TEST_F(ClothMembraneTest, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  const auto list = elements(1000, 0.15);
  check.expect_energy(list);
  check.expect_gradient(list, 2e-6);
  check.expect_no_net_force(list);
  check.expect_rotation_invariance(list);
}

TEST_F(ClothMembraneTest, WorksForAwkwardSizes) { check.expect_awkward_sizes(elements(1000, 0.15)); }

// stretched along both fibres, which stay at right angles: nothing has to be projected
TEST_F(ClothMembraneTest, HessianIsExactWhereItIsPositive) {
  Random random(5);
  std::vector<Element> list;
  for (int i = 0; i < 50; ++i) {
    list.push_back(rest_element(random));
    // the fibres are the axes of the plane z = 0
    const Vec3 stretch(random.number(1.001, 1.1), random.number(1.001, 1.1), 1);
    const Eigen::Matrix3d turn = random.rotation();
    for (Vec3& x : list.back().x) x = turn * stretch.cwiseProduct(x);
  }
  check.expect_exact_hessian(list, 2e-6);
}

// against a numerical projection of numerical second derivatives of each of the two energies
TEST_F(ClothMembraneTest, HessianIsMadeOfTheNearestPositiveOnes) {
  const auto list = elements(60, 0.4);
  const std::vector<EnergyResult> results = check.evaluate(list);
  int n_projected = 0;
  for (std::size_t e = 0; e < list.size(); ++e) {
    const ClothMembrane& p = list[e].params;
    const Deformation F = deformation(p, list[e].x.data());
    MatrixXd sum = MatrixXd::Zero(6, 6);
    for (int which = 0; which < 2; ++which) {
      const double step = 1e-4;
      MatrixXd second(6, 6);
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
          double value = 0;
          for (const double a : {-step, step})
            for (const double b : {-step, step}) {
              Deformation moved = F;
              moved(i % 3, i / 3) += a;
              moved(j % 3, j / 3) += b;
              value += a * b * part(p, which, moved);
            }
          second(i, j) = value / (4 * std::pow(step, 4));
        }
      const MatrixXd projected = nearest_positive(second);
      n_projected += (projected - second).norm() > 1e-3 * second.norm();
      sum += projected;
    }
    MatrixXd B(6, 9);  // vec(dF) = B dx
    for (int k = 0; k < 9; ++k) {
      std::vector<Vec3> unit(3, Vec3::Zero());
      unit[k / 3](k % 3) = 1;
      const Deformation dF = deformation(p, unit.data());
      B.col(k) = Eigen::Map<const Eigen::VectorXd>(dF.data(), 6);
    }
    const MatrixXd expected = p.area * B.transpose() * sum * B;
    ASSERT_LE((results[e].hessian - expected).cwiseAbs().maxCoeff(), 1e-4 * expected.cwiseAbs().maxCoeff())
        << "element " << e;
  }
  EXPECT_GE(n_projected, 60) << "too few elements had anything to project";
}

TEST_F(ClothMembraneTest, HessianIsPositiveForCrushedElementsAndForcesStayFinite) {
  auto list = elements(400, 0.5);
  Random random(6);
  for (Element& e : list) {
    const Vec3 squash(random.number(0.001, 3), random.number(0.001, 1), random.number(0.001, 1));
    for (Vec3& x : e.x) x = squash.cwiseProduct(x);
  }
  for (Vec3& x : list[0].x) x = Vec3::Zero();      // a point
  for (Vec3& x : list[1].x) x = Vec3(x(0), 0, 0);  // a line
  list[2].x[1] = list[2].x[0];
  check.expect_symmetric_positive_hessian(list);
  for (const EnergyResult& r : check.evaluate(list, false)) ASSERT_TRUE(r.gradient.allFinite());
}

// A tensile test along a direction of the plane, free to contract across and to shear: stress by the virial of the
// nodal forces. The secant from -0.1 to 0.1 % of strain is the modulus up to the square of the strain.
struct Tensile {
  double modulus, poisson_ratio;
};
Tensile tensile_test(EnergyCheck<ClothMembrane>& check, Element e, double angle) {
  const std::vector<Vec3> rest = e.x;
  const Matrix2d axes = Eigen::Rotation2Dd(angle).toRotationMatrix();
  // strains along, across, and shear, in the turned axes -> stresses in them
  const auto stress = [&](const Vec3& strain) {
    Matrix2d tensor;
    tensor << strain(0), strain(2), strain(2), strain(1);
    const Matrix2d F = Matrix2d::Identity() + axes * tensor * axes.transpose();
    for (std::size_t a = 0; a < 3; ++a) {
      const Eigen::Vector2d moved = F * rest[a].head<2>();
      e.x[a] = Vec3(moved.x(), moved.y(), 0);
    }
    const Eigen::VectorXd g = check.evaluate({e}, false)[0].gradient;
    Matrix2d sum = Matrix2d::Zero();
    for (int a = 0; a < 3; ++a) sum += g.segment<2>(3 * a) * rest[a].head<2>().transpose();
    const Matrix2d turned = axes.transpose() * sum * axes / e.params.area;
    return Vec3(turned(0, 0), turned(1, 1), (turned(0, 1) + turned(1, 0)) / 2);
  };
  const double step = 1e-4;
  Eigen::Matrix3d stiffness;
  for (int k = 0; k < 3; ++k)
    stiffness.col(k) = (stress(step * Vec3::Unit(k)) - stress(-step * Vec3::Unit(k))) / (2 * step);
  const Vec3 strain = stiffness.inverse() * Vec3(1, 0, 0);
  return {1 / strain(0), -strain(1) / strain(0)};
}

TEST_F(ClothMembraneTest, WithoutCouplingTensileTestsShowTheGivenModuliAndNoPoissonEffectAlongTheFibres) {
  Random random(8);
  for (int i = 0; i < 5; ++i) {
    Element e = rest_element(random);
    e.params.coupling = 0;
    const double u = e.params.stretch_warp, v = e.params.stretch_weft, s = e.params.shear;
    const Tensile warp = tensile_test(check, e, 0), weft = tensile_test(check, e, M_PI / 2);
    EXPECT_NEAR(warp.modulus, u, 1e-4 * u);
    EXPECT_NEAR(weft.modulus, v, 1e-4 * v);
    EXPECT_NEAR(warp.poisson_ratio, 0, 1e-4);
    const Tensile bias = tensile_test(check, e, M_PI / 4);
    const double modulus = 4 / (1 / u + 1 / v + 1 / s);
    EXPECT_NEAR(bias.modulus, modulus, 1e-4 * modulus);
    EXPECT_NEAR(bias.poisson_ratio, modulus / 4 * (1 / s - 1 / u - 1 / v), 1e-4);
  }
}

// E t = 1000 N/m and nu = 0, 0.3: k = E t / (1 - nu^2), k_p = nu k, k_s = E t / (2 (1 + nu))
TEST_F(ClothMembraneTest, IsIsotropicWhereShearIsHalfOfStretchLessCoupling) {
  Random random(9);
  Element e = rest_element(random);
  for (const double nu : {0.0, 0.3}) {
    e.params.stretch_warp = e.params.stretch_weft = 1000 / (1 - nu * nu);
    e.params.coupling = nu * e.params.stretch_warp;
    e.params.shear = 500 / (1 + nu);
    for (const double angle : {0.0, 0.3, 0.7, 1.1}) {
      EXPECT_NEAR(tensile_test(check, e, angle).modulus, 1000, 0.1);
      EXPECT_NEAR(tensile_test(check, e, angle).poisson_ratio, nu, 1e-4);
    }
  }
}

// 1 m x 1 m of rest area stretched along the warp by 5 % with limit 3 % and S = 100:
// E = k (0.05^2/2 + 100 x 0.02^3) = 0.00205 k,  force = k (0.05 + 300 x 0.02^2) = 0.17 k instead of 0.05 k
TEST_F(ClothMembraneTest, FibresStiffenBeyondTheLimit) {
  Random random(10);
  Element e = rest_element(random);
  e.params.coupling = 0;
  for (Vec3& x : e.x) x(0) *= 1.05;
  const EnergyResult r = check.evaluate({e})[0];
  EXPECT_NEAR(r.energy, 0.00205 * e.params.stretch_warp * e.params.area, 1e-12);
  double virial = 0;
  for (int a = 0; a < 3; ++a) virial += r.gradient(3 * a) * e.x[a](0) / 1.05;
  EXPECT_NEAR(virial, 0.17 * e.params.stretch_warp * e.params.area, 1e-9);
}

}  // namespace
}  // namespace pvg::cloth_membrane_test
