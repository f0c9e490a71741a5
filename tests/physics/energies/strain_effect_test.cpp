// What a solid's material adds to its elasticity: stiffening, viscosity, hysteresis by the Green strain
#include "energies/elastic/strain_effect_10.h"
#include "energies/elastic/strain_effect_4.h"
#include "tests/physics/energies/energy_check.hpp"
#include "tests/physics/energies/tetrahedron_check.hpp"

namespace pvg::strain_effect_test {
namespace {

using Eigen::Matrix3d;
using tetrahedron_check::deformation, tetrahedron_check::EDGES, tetrahedron_check::quadrature_point;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// Green's strain at a reference point
template <class Params>
Matrix3d strain(const Params& p, const Vec3* x, const Vec3& r) {
  const Matrix3d F = deformation(p, x, r);
  return 0.5 * (F.transpose() * F - Matrix3d::Identity());
}

template <class Params>
double energy(const Params& p, const Vec3* x, const Vec3* x0, double h) {
  double sum = 0;
  for (int q = 0; q < 4; ++q) {
    const Vec3 r = quadrature_point(q);
    const Matrix3d E = strain(p, x, r), E0 = strain(p, x0, r);
    const double y = (E - E0).norm(), eps = p.strain_rate * h;
    const double f0 = y < eps ? -y * y * y / (3 * eps * eps) + y * y / eps + eps / 3 : y;
    sum += p.volume / 4 *
           (p.stiffening * std::pow(E.squaredNorm(), 2) + p.viscosity * y * y / h + p.hysteresis * E0.norm() * f0);
  }
  return sum;
}

template <class Params>
std::vector<EnergyElement<Params>> solids(std::size_t n, double moved) {
  Random random(41);
  std::vector<EnergyElement<Params>> elements(n);
  for (auto& e : elements) {
    std::vector<Vec3> rest = {Vec3::Zero(), 0.01 * Vec3::UnitX(), 0.01 * Vec3::UnitY(), 0.01 * Vec3::UnitZ()};
    for (Vec3& x : rest) x += random.vector(0.002);
    Matrix3d Dm;
    Dm << rest[1] - rest[0], rest[2] - rest[0], rest[3] - rest[0];
    Eigen::Map<RowMajor3>(e.params.rest_inverse) = Dm.inverse();
    e.params.volume = Dm.determinant() / 6;
    e.params.stiffening = random.number(0, 1e6);
    e.params.viscosity = random.number(0, 1e4);
    e.params.hysteresis = random.number(0, 1) < 0.3 ? 0 : random.number(0, 1e6);
    e.params.strain_rate = 1;
    if (sizeof(e.params.site) == 40)
      for (const auto& edge : EDGES) rest.push_back(0.5 * (rest[edge[0]] + rest[edge[1]]));
    const Matrix3d turn = random.rotation();
    for (const Vec3& x : rest) e.x0.push_back(turn * x + random.vector(1e-3));
    for (const Vec3& x : e.x0) e.x.push_back(x + random.vector(moved));
  }
  return elements;
}

template <class Params>
struct StrainEffect : testing::Test {
  static constexpr int N_NODES = sizeof(Params::site) / sizeof(u32);
  EnergyCheck<Params> check{"elastic/strain_effect_" + std::to_string(N_NODES), energy<Params>, 1e-8};
  StrainEffect() { check.set_energy_scale(1e-3); }
};
using Kinds = testing::Types<StrainEffect4, StrainEffect10>;
TYPED_TEST_SUITE(StrainEffect, Kinds);

TYPED_TEST(StrainEffect, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  for (const double moved : {1e-5, 5e-4}) {  // hysteresis below and above where it is fully developed
    const auto elements = solids<TypeParam>(1000, moved);
    this->check.expect_energy(elements);
    this->check.expect_gradient(elements);
    this->check.expect_no_net_force(elements);
    this->check.expect_symmetric_positive_hessian(elements);
  }
}

TYPED_TEST(StrainEffect, WorksForAwkwardSizes) { this->check.expect_awkward_sizes(solids<TypeParam>(1000, 1e-4)); }

TYPED_TEST(StrainEffect, FeelsNoRotation) { this->check.expect_rotation_invariance(solids<TypeParam>(200, 1e-4)); }

// At rest (E = E0 = 0) the stress vanishes, and with it what the Gauss-Newton Hessian drops: it is exact there.
TYPED_TEST(StrainEffect, HessianIsExactAtRest) {
  auto elements = solids<TypeParam>(20, 0);
  Random random(42);
  for (auto& e : elements) {
    const RowMajor3 inverse = Eigen::Map<const RowMajor3>(e.params.rest_inverse);
    const Matrix3d Dm = inverse.inverse();
    std::vector<Vec3> x = {Vec3::Zero(), Dm.col(0), Dm.col(1), Dm.col(2)};
    if (x.size() < e.x.size())
      for (const auto& edge : EDGES) x.push_back(0.5 * (x[edge[0]] + x[edge[1]]));
    e.x = e.x0 = x;
  }
  this->check.expect_exact_hessian(elements, 1e-4);
}

}  // namespace
}  // namespace pvg::strain_effect_test
