// What rubber adds to stable neo-Hookean tetrahedra: Yeoh's terms, one of Ogden's, the logarithm of the density
#include <Eigen/Eigenvalues>

#include "energies/elastic/hyperelastic_10.h"
#include "energies/elastic/hyperelastic_4.h"
#include "tests/physics/energies/energy_check.hpp"
#include "tests/physics/energies/tetrahedron_check.hpp"

namespace pvg::hyperelastic_test {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using tetrahedron_check::deformation, tetrahedron_check::EDGES, tetrahedron_check::quadrature_point;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr double POISSON_RATIO_PART = 3;  // lambda / mu of the densities whose difference the logarithm is: any

// Smith, De Goes, Kim 2018, equations 13 and 14, by the Lame parameters of small strains
double stable_neo_hookean(const Matrix3d& F, double mu, double lambda, bool has_logarithm) {
  const double I = F.squaredNorm(), J = F.determinant();
  if (!has_logarithm) return mu / 2 * (I - 3) + (lambda + mu) / 2 * std::pow(J - 1 - mu / (lambda + mu), 2);
  const double m = 4. / 3 * mu, l = lambda + 5. / 6 * mu;
  return m / 2 * (I - 3) + l / 2 * std::pow(J - (1 + 3 * m / (4 * l)), 2) - m / 2 * std::log(I + 1);
}

template <class Params>
double density(const Params& p, const Matrix3d& F) {
  const double y = std::pow(F.determinant(), -2. / 3) * F.squaredNorm() - 3;
  double psi = p.yeoh_2 * y * y + p.yeoh_3 * y * y * y;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> c(F.transpose() * F, Eigen::EigenvaluesOnly);
  for (int i = 0; i < 3; ++i)
    psi += 2 * p.ogden / (p.exponent * p.exponent) *
           (std::pow(std::sqrt(c.eigenvalues()[i]) * std::pow(F.determinant(), -1. / 3), p.exponent) - 1);
  const auto difference = [&](const Matrix3d& f) {
    return stable_neo_hookean(f, p.logarithm, POISSON_RATIO_PART * p.logarithm, true) -
           stable_neo_hookean(f, p.logarithm, POISSON_RATIO_PART * p.logarithm, false);
  };
  return p.logarithm == 0 ? psi : psi + difference(F) - difference(Matrix3d::Identity());
}

template <class Params>
double energy(const Params& p, const Vec3* x, const Vec3*, double) {
  double sum = 0;
  for (int q = 0; q < 4; ++q) sum += p.volume / 4 * density(p, deformation(p, x, quadrature_point(q)));
  return sum;
}

enum class Law { yeoh, ogden, logarithm, all };

template <class Params>
void set_law(Params& p, Random& random, Law law) {
  p.exponent = 2;
  if (law == Law::yeoh || law == Law::all) {
    p.yeoh_2 = random.number(-1e5, 1e6);
    p.yeoh_3 = random.number(0, 1e6);
  }
  if (law == Law::ogden || law == Law::all) {
    p.ogden = random.number(-1e5, 1e6);
    p.exponent = random.number(0.5, 10) * (random.number(0, 1) < 0.2 ? -1 : 1);
  }
  if (law == Law::logarithm || law == Law::all) p.logarithm = random.number(0, 1e6);
}

template <class Params>
std::vector<EnergyElement<Params>> solids(std::size_t n, Law law, double moved) {
  Random random(43);
  std::vector<EnergyElement<Params>> elements(n);
  for (auto& e : elements) {
    std::vector<Vec3> rest = {Vec3::Zero(), 0.01 * Vec3::UnitX(), 0.01 * Vec3::UnitY(), 0.01 * Vec3::UnitZ()};
    for (Vec3& x : rest) x += random.vector(0.001);
    Matrix3d Dm;
    Dm << rest[1] - rest[0], rest[2] - rest[0], rest[3] - rest[0];
    Eigen::Map<RowMajor3>(e.params.rest_inverse) = Dm.inverse();
    e.params.volume = Dm.determinant() / 6;
    set_law(e.params, random, law);
    if (sizeof(e.params.site) == 40)
      for (const auto& edge : EDGES) rest.push_back(0.5 * (rest[edge[0]] + rest[edge[1]]));
    const Matrix3d turn = random.rotation();
    const Vec3 stretch =
        moved > 0 ? Vec3(random.number(1, 2), random.number(0.7, 1), random.number(0.7, 1)) : Vec3::Ones();
    for (const Vec3& x : rest) e.x.push_back(turn * stretch.cwiseProduct(x) + random.vector(moved));
    e.x0 = e.x;
  }
  return elements;
}

constexpr Law LAWS[] = {Law::yeoh, Law::ogden, Law::logarithm, Law::all};

template <class Params>
struct Hyperelastic : testing::Test {
  static constexpr int N_NODES = sizeof(Params::site) / sizeof(u32);
  EnergyCheck<Params> check{"elastic/hyperelastic_" + std::to_string(N_NODES), energy<Params>, 1e-7};
  Hyperelastic() { check.set_energy_scale(1e-2); }
};
using Kinds = testing::Types<Hyperelastic4, Hyperelastic10>;
TYPED_TEST_SUITE(Hyperelastic, Kinds);

TYPED_TEST(Hyperelastic, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  for (const Law law : LAWS) {
    const auto elements = solids<TypeParam>(250, law, 3e-4);
    this->check.expect_energy(elements);
    this->check.expect_gradient(elements);
    this->check.expect_no_net_force(elements);
    this->check.expect_rotation_invariance(elements);
    this->check.expect_symmetric_positive_hessian(elements);
  }
}

TYPED_TEST(Hyperelastic, WorksForAwkwardSizes) {
  this->check.expect_awkward_sizes(solids<TypeParam>(1000, Law::all, 3e-4));
}

TYPED_TEST(Hyperelastic, RestIsWithoutEnergyAndForceInAnyOrientation) {
  const auto elements = solids<TypeParam>(100, Law::all, 0);
  for (const EnergyResult& r : this->check.evaluate(elements)) {
    EXPECT_LE(r.gradient.cwiseAbs().maxCoeff(), 1e-9);  // of 1e6 Pa times 1e-4 m^2
    EXPECT_LE(std::abs(r.energy), 1e-13);               // of 1e6 Pa times 2e-7 m^3
    EXPECT_TRUE(r.hessian.allFinite());
  }
}

// d2psi/dF2 by differences, F column by column
template <class Params>
MatrixXd density_hessian(const Params& p, const Matrix3d& F) {
  const double step = 1e-3;
  MatrixXd hessian(9, 9);
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) {
      const auto at_step = [&](double size) {
        double sum = 0;
        for (const double a : {-size, size})
          for (const double b : {-size, size}) {
            Matrix3d moved = F;
            moved(i % 3, i / 3) += a;
            moved(j % 3, j / 3) += b;
            sum += a * b * density(p, moved);
          }
        return sum / (4 * std::pow(size, 4));
      };
      hessian(i, j) = (4 * at_step(step) - at_step(2 * step)) / 3;  // without the error of second order
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
    unit[std::size_t(k / 3)](k % 3) = 1;
    const Matrix3d dF = deformation(p, unit.data(), r);
    B.col(k) = Eigen::Map<const Eigen::VectorXd>(dF.data(), 9);
  }
  return B;
}

// against a numerical projection of numerical second derivatives of the density, at every quadrature point
TYPED_TEST(Hyperelastic, HessianIsMadeOfTheNearestPositiveOnes) {
  int n_projected = 0;
  for (const Law law : LAWS) {
    const auto elements = solids<TypeParam>(10, law, 3e-4);
    const std::vector<EnergyResult> results = this->check.evaluate(elements);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const TypeParam& p = elements[e].params;
      MatrixXd expected = MatrixXd::Zero(this->check.SIZE, this->check.SIZE);
      for (int q = 0; q < 4; ++q) {
        const MatrixXd B = deformation_derivative(p, quadrature_point(q));
        const MatrixXd C = density_hessian(p, deformation(p, elements[e].x.data(), quadrature_point(q)));
        const MatrixXd projected = nearest_positive(C);
        n_projected += (projected - C).norm() > 1e-3 * C.norm();
        expected += p.volume / 4 * B.transpose() * projected * B;
      }
      ASSERT_LE((results[e].hessian - expected).cwiseAbs().maxCoeff(), 1e-4 * expected.cwiseAbs().maxCoeff())
          << "element " << e << " of law " << int(law);
    }
  }
  EXPECT_GE(n_projected, 10) << "too few had anything to project";
}

// two equal stretches, where (W_i - W_j) / (s_i - s_j) is its limit
TYPED_TEST(Hyperelastic, HessianIsRightWhereStretchesAreEqual) {
  for (const double apart : {0.0, 1e-9, 1e-5, 1e-3}) {
    auto elements = solids<TypeParam>(4, Law::ogden, 0);
    for (auto& e : elements) {
      e.params.ogden = 1e6;
      e.params.exponent = 6;
      for (Vec3& x : e.x) x = Vec3(1.5 * x(0), (0.9 + apart) * x(1), 0.9 * x(2));
    }
    const std::vector<EnergyResult> results = this->check.evaluate(elements);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const TypeParam& p = elements[e].params;
      MatrixXd expected = MatrixXd::Zero(this->check.SIZE, this->check.SIZE);
      for (int q = 0; q < 4; ++q) {
        const MatrixXd B = deformation_derivative(p, quadrature_point(q));
        const Matrix3d F = deformation(p, elements[e].x.data(), quadrature_point(q));
        expected += p.volume / 4 * B.transpose() * nearest_positive(density_hessian(p, F)) * B;
      }
      ASSERT_LE((results[e].hessian - expected).cwiseAbs().maxCoeff(), 1e-4 * expected.cwiseAbs().maxCoeff());
    }
  }
}

// nominal stress of a uniaxial stretch l without change of volume, from the virial of the nodal forces, along less
// across
TYPED_TEST(Hyperelastic, TensileTestShowsTheTextbookLaws) {
  for (const double l : {0.6, 1.1, 1.7, 2.5}) {
    EnergyElement<TypeParam> e = solids<TypeParam>(1, Law::all, 0)[0];
    e.params.yeoh_2 = -2e4;
    e.params.yeoh_3 = 3e4;
    e.params.ogden = 1e5;
    e.params.exponent = 5;
    e.params.logarithm = 0;
    std::vector<Vec3> rest = {Vec3::Zero()};
    const Matrix3d Dm = Eigen::Map<const RowMajor3>(e.params.rest_inverse).inverse();
    for (int k = 0; k < 3; ++k) rest.push_back(Dm.col(k));
    if (e.x.size() == 10)
      for (const auto& edge : EDGES) rest.push_back(0.5 * (rest[std::size_t(edge[0])] + rest[std::size_t(edge[1])]));
    const Vec3 stretch(l, 1 / std::sqrt(l), 1 / std::sqrt(l));
    for (std::size_t a = 0; a < rest.size(); ++a) e.x[a] = stretch.cwiseProduct(rest[a]);
    e.x0 = e.x;
    const Eigen::VectorXd g = this->check.evaluate({e}, false)[0].gradient;
    Vec3 nominal = Vec3::Zero();
    for (std::size_t a = 0; a < rest.size(); ++a)
      nominal += g.template segment<3>(3 * Eigen::Index(a)).cwiseProduct(rest[a]);
    nominal /= e.params.volume;
    const double y = l * l + 2 / l - 3;
    const double yeoh = 2 * (l - 1 / (l * l)) * (2 * -2e4 * y + 3 * 3e4 * y * y);
    const double ogden = 2 * 1e5 / 5 * (std::pow(l, 4) - std::pow(l, -3.5));
    const double found = nominal(0) - nominal(1) * stretch(1) / l;  // without the pressure, which does no work here
    EXPECT_NEAR(found, yeoh + ogden, 1e-9 * std::abs(yeoh + ogden)) << "at stretch " << l;
  }
}

TYPED_TEST(Hyperelastic, AnInvertedElementHasInfiniteEnergy) {
  auto elements = solids<TypeParam>(20, Law::all, 0);
  for (auto& e : elements)
    for (Vec3& x : e.x) x(1) *= -1;
  for (const EnergyResult& r : this->check.evaluate(elements, false)) EXPECT_EQ(r.energy, INFINITY);
}

}  // namespace
}  // namespace pvg::hyperelastic_test
