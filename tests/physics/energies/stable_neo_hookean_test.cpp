// Stable neo-Hookean tetrahedra with 4 and 10 nodes:
//   Psi = mu/2 (|F|^2 - 3) + lambda'/2 (J - 1 - mu/lambda')^2 - mu^2/(2 lambda'),  lambda' = lambda + mu
#include "energies/elastic/stable_neo_hookean_10.h"
#include "energies/elastic/stable_neo_hookean_4.h"
#include "tests/physics/energies/energy_check.hpp"
#include "tests/physics/energies/tetrahedron_check.hpp"

namespace pvg::stable_neo_hookean_test {
namespace {

using Eigen::Matrix3d;
using tetrahedron_check::deformation, tetrahedron_check::EDGES, tetrahedron_check::quadrature_point;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Eigen::MatrixXd;

double density(const Matrix3d& F, double mu, double lambda) {
  const double stiffened = lambda + mu;
  return mu / 2 * (F.squaredNorm() - 3) + stiffened / 2 * std::pow(F.determinant() - 1 - mu / stiffened, 2) -
         mu * mu / (2 * stiffened);
}

template <class Params>
double energy(const Params& p, const Vec3* x, const Vec3*, double) {
  double sum = 0;
  for (int q = 0; q < 4; ++q) sum += p.volume / 4 * density(deformation(p, x, quadrature_point(q)), p.mu, p.lambda);
  return sum;
}

template <class Params>
void set_material(Params& p, double youngs_modulus, double poisson_ratio) {
  p.mu = youngs_modulus / (2 * (1 + poisson_ratio));
  p.lambda = youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
}

// sets the rest shape from its corners; returns all nodes
template <class Params>
std::vector<Vec3> set_rest(Params& p, const std::vector<Vec3>& corners) {
  Matrix3d Dm;
  Dm << corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0];
  Eigen::Map<RowMajor3>(p.rest_inverse) = Dm.inverse();
  p.volume = Dm.determinant() / 6;
  std::vector<Vec3> x = corners;
  if (sizeof(p.site) / sizeof(u32) == 10)
    for (const auto& edge : EDGES) x.push_back(0.5 * (corners[edge[0]] + corners[edge[1]]));
  return x;
}

// corners of a tetrahedron with legs of 10 mm, moved by up to `amount`
std::vector<Vec3> corners(Random& random, double amount) {
  std::vector<Vec3> c = {Vec3::Zero(), 0.01 * Vec3::UnitX(), 0.01 * Vec3::UnitY(), 0.01 * Vec3::UnitZ()};
  const Matrix3d turn = random.rotation();
  for (Vec3& v : c) v = turn * (v + random.vector(amount));
  return c;
}

// random elements, turned, swollen by `stretch` and with each coordinate moved by up to `amount` [m]
template <class Params>
std::vector<EnergyElement<Params>> make_elements(
    std::size_t n, double amount, double (*stretch)(const Params&) = [](const Params&) { return 1.0; }) {
  Random random(4);
  std::vector<EnergyElement<Params>> elements(n);
  for (auto& e : elements) {
    set_material(e.params, random.number(1e5, 1e8), random.number(0.2, 0.48));
    e.x0 = set_rest(e.params, corners(random, 0.002));
    e.x = e.x0;
    const Matrix3d turn = stretch(e.params) * random.rotation();
    for (Vec3& x : e.x) x = turn * x + random.vector(amount);
  }
  return elements;
}

template <class Params>
struct StableNeoHookean : testing::Test {
  static constexpr int N_NODES = sizeof(Params::site) / sizeof(u32);
  EnergyCheck<Params> check{"elastic/stable_neo_hookean_" + std::to_string(N_NODES), energy<Params>, 1e-7};
  StableNeoHookean() { check.set_energy_scale(1e-3); }
};
using Kinds = testing::Types<StableNeoHookean4, StableNeoHookean10>;
TYPED_TEST_SUITE(StableNeoHookean, Kinds);

TYPED_TEST(StableNeoHookean, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  const auto elements = make_elements<TypeParam>(1000, 2e-4);
  this->check.expect_energy(elements);
  this->check.expect_gradient(elements);
  this->check.expect_no_net_force(elements);
  this->check.expect_rotation_invariance(elements);
}

TYPED_TEST(StableNeoHookean, WorksForAwkwardSizes) {
  this->check.expect_awkward_sizes(make_elements<TypeParam>(1000, 2e-4));
}

// swollen until the pressure balances mu, where every eigenvalue is about mu or more: nothing to project
TYPED_TEST(StableNeoHookean, HessianIsExactWhereItIsPositive) {
  const auto swell = [](const TypeParam& p) { return std::cbrt(1 + p.mu / (p.lambda + p.mu)); };
  this->check.expect_exact_hessian(make_elements<TypeParam>(50, 2e-5, swell));
}

// d2Psi/dF2 by differences, F column by column
MatrixXd density_hessian(const Matrix3d& F, double mu, double lambda) {
  const double step = 1e-3;
  MatrixXd hessian(9, 9);
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) {
      double sum = 0;
      for (const double a : {-step, step})
        for (const double b : {-step, step}) {
          Matrix3d moved = F;
          moved(i % 3, i / 3) += a;
          moved(j % 3, j / 3) += b;
          sum += a * b * density(moved, mu, lambda);
        }
      hessian(i, j) = sum / (4 * std::pow(step, 4));
    }
  return hessian;
}

// vec(dF) = B dx at the reference point r
template <class Params>
MatrixXd deformation_derivative(const Params& p, const Vec3& r) {
  constexpr int n_nodes = sizeof(p.site) / sizeof(u32);
  MatrixXd B(9, 3 * n_nodes);
  for (int k = 0; k < 3 * n_nodes; ++k) {
    std::vector<Vec3> unit(n_nodes, Vec3::Zero());
    unit[k / 3](k % 3) = 1;
    const Matrix3d dF = deformation(p, unit.data(), r);
    B.col(k) = Eigen::Map<const Eigen::VectorXd>(dF.data(), 9);
  }
  return B;
}

// against a numerical projection of numerical second derivatives of the density, at every quadrature point
TYPED_TEST(StableNeoHookean, HessianIsMadeOfTheNearestPositiveOnes) {
  const auto elements = make_elements<TypeParam>(50, 1e-3);
  const std::vector<EnergyResult> results = this->check.evaluate(elements);
  int n_projected = 0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const TypeParam& p = elements[e].params;
    MatrixXd expected = MatrixXd::Zero(this->check.SIZE, this->check.SIZE);
    for (int q = 0; q < 4; ++q) {
      const MatrixXd B = deformation_derivative(p, quadrature_point(q));
      const MatrixXd C = density_hessian(deformation(p, elements[e].x.data(), quadrature_point(q)), p.mu, p.lambda);
      const MatrixXd projected = nearest_positive(C);
      n_projected += (projected - C).norm() > 1e-3 * C.norm();
      expected += p.volume / 4 * B.transpose() * projected * B;
    }
    ASSERT_LE((results[e].hessian - expected).cwiseAbs().maxCoeff(), 1e-4 * expected.cwiseAbs().maxCoeff())
        << "element " << e;
  }
  EXPECT_GE(n_projected, 20) << "too few elements had anything to project";
}

TYPED_TEST(StableNeoHookean, HessianIsPositiveForCrushedElements) {
  auto elements = make_elements<TypeParam>(400, 1e-3);
  Random random(6);
  for (auto& e : elements) {
    const Vec3 squash(random.number(0.001, 3), random.number(0.001, 1), random.number(0.5, 1));
    for (Vec3& x : e.x) x = squash.cwiseProduct(x);
  }
  // a point, a line, a plane: singular values of zero
  for (Vec3& x : elements[0].x) x = Vec3::Zero();
  for (Vec3& x : elements[1].x) x = Vec3(x(0), 0, 0);
  for (Vec3& x : elements[2].x) x(2) = 0;
  this->check.expect_symmetric_positive_hessian(elements);
}

TYPED_TEST(StableNeoHookean, RestIsWithoutEnergyAndForceInAnyOrientation) {
  const auto elements = make_elements<TypeParam>(100, 0);
  const std::vector<EnergyResult> results = this->check.evaluate(elements);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const double force = elements[e].params.lambda * std::pow(elements[e].params.volume, 2. / 3);
    EXPECT_LE(results[e].gradient.cwiseAbs().maxCoeff(), 1e-13 * force);
    EXPECT_LE(std::abs(results[e].energy), 1e-14 * elements[e].params.lambda * elements[e].params.volume);
  }
}

// A tensile test: stretched along x, free to contract in y and z; nominal stress by the virial of the nodal forces.
// The secant from -0.5 % to +0.5 % of strain is Young's modulus up to the square of the strain.
TYPED_TEST(StableNeoHookean, TensileTestShowsTheGivenYoungsModulus) {
  for (const double nu : {0.0, 0.3, 0.4, 0.45, 0.49, 0.499}) {
    Random random(8);
    EnergyElement<TypeParam> e;
    set_material(e.params, 2e6, nu);
    const std::vector<Vec3> rest = set_rest(e.params, corners(random, 0.002));
    const auto stress = [&](double along, double across) {
      e.x = rest;
      for (Vec3& x : e.x) x = Vec3(along * x(0), across * x(1), across * x(2));
      e.x0 = e.x;
      const Eigen::VectorXd g = this->check.evaluate({e}, false)[0].gradient;
      Vec3 diagonal = Vec3::Zero();
      for (std::size_t a = 0; a < rest.size(); ++a) diagonal += g.segment<3>(3 * a).cwiseProduct(rest[a]);
      return Vec3(diagonal / e.params.volume);
    };
    // the stretch across at which the stress across vanishes, by secants
    const auto tension = [&](double along) {
      double before = 1, now = 1 - nu * (along - 1) + 1e-4, stress_before = stress(along, before)(1);
      for (int i = 0; i < 6; ++i) {
        const double stress_now = stress(along, now)(1);
        const double next = now - stress_now * (now - before) / (stress_now - stress_before);
        before = now;
        stress_before = stress_now;
        now = next;
        if (std::abs(now - before) < 1e-12) break;
      }
      return stress(along, now)(0);
    };
    const double modulus = (tension(1.005) - tension(0.995)) / 0.01;
    EXPECT_NEAR(modulus / 2e6, 1, 1e-3) << "at Poisson's ratio " << nu;
  }
}

TYPED_TEST(StableNeoHookean, AnInvertedElementHasInfiniteEnergy) {
  auto elements = make_elements<TypeParam>(100, 0);
  for (auto& e : elements)
    for (Vec3& x : e.x) x(1) *= -1;
  elements[0].x[0](0) = std::nan("");
  for (Vec3& x : elements[1].x) x(2) = 0;
  for (const EnergyResult& r : this->check.evaluate(elements, false)) EXPECT_EQ(r.energy, INFINITY);
}

TEST(StableNeoHookean10, FoldedMidpointsAndFoldedCornersHaveInfiniteEnergy) {
  EnergyCheck<StableNeoHookean10> check("elastic/stable_neo_hookean_10", energy<StableNeoHookean10>, 1e-7);
  auto elements = make_elements<StableNeoHookean10>(2, 0);
  // a midpoint pushed far beyond its corner turns the map over at a quadrature point
  elements[0].x[4] += 2 * (elements[0].x[1] - elements[0].x[0]);
  // the corners alone mirrored
  const Vec3 x1 = elements[1].x[1];
  elements[1].x[1] = elements[1].x[2];
  elements[1].x[2] = x1;
  for (const EnergyResult& r : check.evaluate(elements, false)) EXPECT_EQ(r.energy, INFINITY);
}

// a homogeneous deformation: the quadratic element is as good as the linear one, its corner forces aside
TEST(StableNeoHookean10, HomogeneousDeformationCostsWhatTheLinearElementSays) {
  EnergyCheck<StableNeoHookean10> check_10("elastic/stable_neo_hookean_10", energy<StableNeoHookean10>, 1e-7);
  EnergyCheck<StableNeoHookean4> check_4("elastic/stable_neo_hookean_4", energy<StableNeoHookean4>, 1e-7);
  Random random(9);
  for (int i = 0; i < 20; ++i) {
    EnergyElement<StableNeoHookean10> ten;
    EnergyElement<StableNeoHookean4> four;
    set_material(ten.params, 1e6, 0.45);
    set_material(four.params, 1e6, 0.45);
    const std::vector<Vec3> c = corners(random, 0.002);
    ten.x = ten.x0 = set_rest(ten.params, c);
    four.x = four.x0 = set_rest(four.params, c);
    Matrix3d F = Matrix3d::Identity();
    for (int k = 0; k < 3; ++k) F.col(k) += random.vector(0.2);
    for (Vec3& x : ten.x) x = F * x;
    for (Vec3& x : four.x) x = F * x;
    const double expected = check_4.evaluate({four})[0].energy;
    EXPECT_NEAR(check_10.evaluate({ten})[0].energy, expected, 1e-11 * expected);
  }
}

}  // namespace
}  // namespace pvg::stable_neo_hookean_test
