// Orthogonality of an affine body: E = k |A^T A - 1|^2
#include "energies/body/affine_orthogonality.h"

#include "tests/physics/energies/energy_check.hpp"

namespace pvg::affine_orthogonality_test {
namespace {

using Element = EnergyElement<AffineOrthogonality>;

double energy(const AffineOrthogonality& p, const Vec3* a, const Vec3*, double) {
  Eigen::Matrix3d A;
  A << a[0], a[1], a[2];
  return p.stiffness * (A.transpose() * A - Eigen::Matrix3d::Identity()).squaredNorm();
}

std::vector<Vec3> columns(const Eigen::Matrix3d& A) { return {A.col(0), A.col(1), A.col(2)}; }

// rotations strained by up to `strain`
std::vector<Element> bodies(std::size_t n, double strain) {
  Random random(2);
  std::vector<Element> elements(n);
  for (Element& e : elements) {
    e.params.stiffness = random.number(1, 1e6);
    Eigen::Matrix3d A = random.rotation();
    for (int i = 0; i < 3; ++i) A.col(i) += random.vector(strain);
    e.x = columns(A);
    e.x0 = columns(random.rotation());
  }
  return elements;
}

TEST(AffineOrthogonality, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  EnergyCheck<AffineOrthogonality> check("body/affine_orthogonality", energy, 1e-5);
  const auto elements = bodies(1000, 0.4);
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_symmetric_positive_hessian(elements);
  check.expect_rotation_invariance(elements);
  check.expect_awkward_sizes(elements);
}

// every eigenvalue of a stretched body is positive: twist = 4 (s_i^2 - s_i s_j + s_j^2 - 1) > 0
TEST(AffineOrthogonality, HessianIsExactForAStretchedBody) {
  EnergyCheck<AffineOrthogonality> check("body/affine_orthogonality", energy, 1e-5);
  Random random(3);
  std::vector<Element> elements = bodies(50, 0);
  for (Element& e : elements) {
    const Vec3 stretch(random.number(1.2, 1.3), random.number(1.2, 1.3), random.number(1.2, 1.3));
    e.x = columns(random.rotation() * stretch.asDiagonal() * random.rotation());
  }
  check.expect_exact_hessian(elements);
}

// the closed form against a numerical projection of the differences, also for reflections and flat bodies
TEST(AffineOrthogonality, HessianIsTheNearestPositiveOne) {
  EnergyCheck<AffineOrthogonality> check("body/affine_orthogonality", energy, 1e-5);
  std::vector<Element> elements = bodies(200, 0.6);
  elements[0].x = columns(Vec3(1, 1, -1).asDiagonal());
  elements[1].x = columns(Vec3(1, 0.5, 0).asDiagonal());
  elements[2].x = columns(Eigen::Matrix3d::Zero());
  elements[3].x = columns(Eigen::Matrix3d::Identity());
  elements[4].x = columns(Vec3(0.5, 0.5, 0.5).asDiagonal());
  const std::vector<EnergyResult> results = check.evaluate(elements);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Eigen::MatrixXd nearest = nearest_positive(check.difference_hessian(elements[e]));
    ASSERT_LE((results[e].hessian - nearest).cwiseAbs().maxCoeff(), 1e-6 * elements[e].params.stiffness * 10)
        << "element " << e;
  }
}

// a_1 longer by 1 %: (1.0201 - 1)^2 k, and a force of 4 k 0.0201 1.01 along it
TEST(AffineOrthogonality, OnePercentStretchByHand) {
  EnergyCheck<AffineOrthogonality> check("body/affine_orthogonality", energy, 1e-5);
  Element e;
  e.params.stiffness = 1000;
  e.x = e.x0 = columns(Vec3(1.01, 1, 1).asDiagonal());
  const EnergyResult r = check.evaluate({e})[0];
  EXPECT_NEAR(r.energy, 0.40401, 1e-12);
  EXPECT_NEAR(r.gradient(0), 81.204, 1e-9);
  EXPECT_NEAR(r.gradient.tail(8).norm(), 0, 1e-9);
}

TEST(AffineOrthogonality, ARotationIsAtRest) {
  EnergyCheck<AffineOrthogonality> check("body/affine_orthogonality", energy, 1e-5);
  for (const EnergyResult& r : check.evaluate(bodies(100, 0))) {
    EXPECT_LE(r.energy, 1e-22);  // the square of a rounding error, times 1e6 J
    EXPECT_LE(r.gradient.norm(), 1e-8);
  }
}

}  // namespace
}  // namespace pvg::affine_orthogonality_test
