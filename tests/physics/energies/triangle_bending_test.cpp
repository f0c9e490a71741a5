// Bending of a triangle with its neighbours:  E = 1/2 (theta - rest)^T K (theta - rest), and the K that makes a bent
// cylinder cost B k^2 / 2 per area.
#include "energies/elastic/triangle_bending.h"
#include "host/physics/energies/cloth.hpp"
#include "tests/physics/energies/cloth_check.hpp"
#include "tests/physics/energies/energy_check.hpp"

namespace pvg::triangle_bending_test {
namespace {

double stiffness(const TriangleBending& p, int i, int j) {
  const int index[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  return p.stiffness[index[i][j]];
}

// turn about the edge from the triangle's normal to the neighbour's; positive towards the normal
double angle(const Vec3* x, int i) {
  const Vec3 from = x[(i + 1) % 3], edge = (x[(i + 2) % 3] - from).normalized();
  const Vec3 own = (x[i] - from - edge * edge.dot(x[i] - from)).normalized();
  const Vec3 other = (x[i + 3] - from - edge * edge.dot(x[i + 3] - from)).normalized();
  // flat: own and other are opposite
  const double folded = std::acos(std::clamp(-own.dot(other), -1.0, 1.0));
  return other.dot(edge.cross(own)) > 0 ? folded : -folded;
}

double energy(const TriangleBending& p, const Vec3* x, const Vec3*, double) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (stiffness(p, i, i) > 0 && stiffness(p, j, j) > 0)
        sum += 0.5 * stiffness(p, i, j) * (angle(x, i) - p.rest_angle[i]) * (angle(x, j) - p.rest_angle[j]);
  return sum;
}

using Element = EnergyElement<TriangleBending>;

// a triangle of about 10 mm with its neighbours, each folded by up to `fold` [rad]; every fifth lacks a neighbour
std::vector<Element> elements(std::size_t n, double fold, double rest = 0.5) {
  Random random(2);
  std::vector<Element> list;
  for (std::size_t k = 0; k < n; ++k) {
    Element e;
    Vec3 x[6] = {{0, 0, 0}, {0.01, 0, 0}, {0.004, 0.009, 0}};
    for (int i = 0; i < 3; ++i) x[i] += Vec3(random.number(-1, 1), random.number(-1, 1), 0) * 0.001;
    Eigen::Matrix3d root;
    for (int i = 0; i < 3; ++i) root.col(i) = random.vector(3e-3);
    Eigen::Matrix3d K = root * root.transpose() + 1e-6 * Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) {
      const Vec3 from = x[(i + 1) % 3], to = x[(i + 2) % 3];
      const Vec3 flat = from + to - x[i] + 0.001 * Vec3(random.number(-1, 1), random.number(-1, 1), 0);
      // the sign of the turn that raises the neighbour
      const Eigen::AngleAxisd turn(-random.number(-fold, fold), (to - from).normalized());
      x[i + 3] = from + turn * (flat - from);
      e.params.rest_angle[i] = random.number(-rest, rest);
    }
    if (k % 5 == 0) {
      const int missing = int(k / 5 % 3);
      K.row(missing).setZero();
      K.col(missing).setZero();
      x[missing + 3] = x[missing];
      e.params.rest_angle[missing] = 0;
    }
    for (int a = 0, m = 0; a < 3; ++a)
      for (int b = a; b < 3; ++b) e.params.stiffness[m++] = K(a, b);
    const Eigen::Matrix3d turn = random.rotation();
    const Vec3 shift = random.vector(0.02);
    for (const Vec3& point : x) e.x.push_back(turn * point + shift);
    e.x0 = e.x;
    list.push_back(e);
  }
  return list;
}

struct TriangleBendingTest : testing::Test {
  EnergyCheck<TriangleBending> check{"elastic/triangle_bending", energy, 1e-7};
  TriangleBendingTest() { check.set_energy_scale(1e-8); }
};

TEST_F(TriangleBendingTest, EnergyAndGradientAgreeWithTheEnergyInDouble) {
  auto list = elements(1000, 2.8);
  // arccos is blunt near zero; the flat state has its own test
  std::erase_if(list, [](const Element& e) {
    for (int i = 0; i < 3; ++i)
      if (stiffness(e.params, i, i) > 0 && std::abs(angle(e.x.data(), i)) < 0.05) return true;
    return false;
  });
  ASSERT_GE(list.size(), 800u);
  check.expect_energy(list);
  check.expect_gradient(list, 1e-5);
  check.expect_no_net_force(list);
  check.expect_rotation_invariance(list);
}

TEST_F(TriangleBendingTest, WorksForAwkwardSizes) { check.expect_awkward_sizes(elements(1000, 1.5)); }

TEST_F(TriangleBendingTest, HessianIsExactAtRest) {
  auto list = elements(100, 1.5);
  for (Element& e : list)
    for (int i = 0; i < 3; ++i) e.params.rest_angle[i] = stiffness(e.params, i, i) > 0 ? angle(e.x.data(), i) : 0;
  check.expect_exact_hessian(list, 1e-4);
}

TEST_F(TriangleBendingTest, HessianIsPositiveForCrushedElementsAndForcesStayFinite) {
  auto list = elements(300, 3);
  Random random(4);
  for (Element& e : list)
    for (Vec3& x : e.x) x = x.cwiseProduct(Vec3(1, 1, random.number(0.01, 1)));
  for (Vec3& x : list[1].x) x(2) = 0;
  list[2].x[3] = 0.5 * (list[2].x[1] + list[2].x[2]);  // a neighbour without area
  check.expect_symmetric_positive_hessian(list);
  for (const EnergyResult& r : check.evaluate(list, false)) ASSERT_TRUE(r.gradient.allFinite());
}

TEST_F(TriangleBendingTest, AFlatSheetIsWithoutEnergyAndForce) {
  for (const EnergyResult& r : check.evaluate(elements(200, 0, 0), false)) {
    EXPECT_LE(std::abs(r.energy), 1e-20);
    EXPECT_LE(r.gradient.cwiseAbs().maxCoeff(), 1e-12);
  }
}

// ---- the stiffness of a mesh: energy per area of a cylinder of curvature k about any axis, against B k^2 / 2

// The energy of all elements over the patch of half the width in the middle; the mesh is bent to a cylinder.
double cylinder_energy(EnergyCheck<TriangleBending>& check, const Cloth& cloth, double curvature, double direction) {
  const Vec3 across(std::cos(direction), std::sin(direction), 0), along(-across.y(), across.x(), 0);
  std::vector<Element> list;
  double area = 0;
  for (const TriangleBending& row : triangle_bending_elements(cloth, 0)) {
    Vec3 centre = Vec3::Zero();
    for (int k = 0; k < 3; ++k) centre += cloth.mesh.points[row.site[k]] / 3;
    if (std::max(std::abs(centre.x()), std::abs(centre.y())) > 0.05) continue;
    const Vec3* x = cloth.mesh.points.data();
    area += (x[row.site[1]] - x[row.site[0]]).cross(x[row.site[2]] - x[row.site[0]]).norm() / 2;
    Element e;
    e.params = row;
    for (const u32 site : row.site) {
      const double s = x[site].dot(across);
      e.x.push_back(along * x[site].dot(along) + across * std::sin(curvature * s) / curvature +
                    Vec3::UnitZ() * (1 - std::cos(curvature * s)) / curvature);
    }
    e.x0 = e.x;
    list.push_back(e);
  }
  double sum = 0;
  for (const EnergyResult& r : check.evaluate(list, false)) sum += r.energy;
  return sum / area;
}

Cloth centred_sheet(ClothGrid kind, double bending_warp, double bending_weft) {
  Cloth cloth = cloth_sheet(kind, 20, 20, 0.01);
  for (Vec3& x : cloth.mesh.points) x -= Vec3(0.1, 0.1, 0);
  cloth.material.bending_warp = bending_warp;
  cloth.material.bending_weft = bending_weft;
  return cloth;
}

// radius 0.5 m, edges of 10 mm
TEST_F(TriangleBendingTest, ACylinderCostsItsFlexuralRigidityInEveryDirectionOfAGridOfEqualTriangles) {
  const Cloth cloth = centred_sheet(ClothGrid::right, 3e-5, 3e-5);
  for (const double direction : {0.0, 0.5, M_PI / 4, M_PI / 2, 2.0, 3 * M_PI / 4})
    EXPECT_NEAR(cylinder_energy(check, cloth, 2, direction) / (3e-5 * 2), 1, 1e-3) << "direction " << direction;
}

// inner points moved by up to 0.3 of an edge. What a cylinder costs whose nodes lie on it; a sheet in equilibrium finds
// a cheaper shape near it (see the heavy cantilever).
TEST_F(TriangleBendingTest, ACylinderCostsMoreOnIrregularTrianglesThanOnEqualOnes) {
  const Cloth right = centred_sheet(ClothGrid::irregular, 3e-5, 3e-5);
  Cloth equilateral = right;
  for (Vec3& x : equilateral.mesh.points) x = Vec3(x.x() - x.y() / 2, x.y() * std::sqrt(0.75), 0);
  for (const double direction : {0.0, 0.5, M_PI / 4, M_PI / 2, 2.0, 3 * M_PI / 4}) {
    const double by_equilateral = cylinder_energy(check, equilateral, 2, direction) / (3e-5 * 2);
    const double by_right = cylinder_energy(check, right, 2, direction) / (3e-5 * 2);
    EXPECT_GE(std::min(by_equilateral, by_right), 1) << "direction " << direction;
    EXPECT_LE(by_equilateral, 1.2) << "direction " << direction;
    EXPECT_LE(by_right, 2.2) << "direction " << direction;
  }
}

TEST_F(TriangleBendingTest, AGridCutAlongBothDiagonalsIsExactAlongItsAxesAndTooStiffByHalfOnTheBias) {
  const Cloth cloth = centred_sheet(ClothGrid::alternating, 3e-5, 3e-5);
  EXPECT_NEAR(cylinder_energy(check, cloth, 2, 0) / (3e-5 * 2), 1, 1e-3);
  EXPECT_NEAR(cylinder_energy(check, cloth, 2, M_PI / 2) / (3e-5 * 2), 1, 1e-3);
  EXPECT_NEAR(cylinder_energy(check, cloth, 2, M_PI / 4) / (3e-5 * 2), 1.5, 2e-3);
}

TEST_F(TriangleBendingTest, WarpAndWeftHaveTheirOwnRigidity) {
  const Cloth cloth = centred_sheet(ClothGrid::right, 4e-5, 1e-5);
  EXPECT_NEAR(cylinder_energy(check, cloth, 2, 0) / (4e-5 * 2), 1, 1e-3);
  EXPECT_NEAR(cylinder_energy(check, cloth, 2, M_PI / 2) / (1e-5 * 2), 1, 1e-3);
  // on the bias: (sqrt(B_u) + sqrt(B_v))^2 / 4
  EXPECT_NEAR(cylinder_energy(check, cloth, 2, M_PI / 4) / (2.25e-5 * 2), 1, 1e-3);
}

TEST_F(TriangleBendingTest, ACylinderAtRestHasNoMomentUnlessItsRestIsFlat) {
  Cloth cloth = cloth_sheet(ClothGrid::right, 10, 4, 0.01);
  for (Vec3& x : cloth.mesh.points) x = Vec3(0.05 * std::sin(x.x() / 0.05), x.y(), -0.05 * std::cos(x.x() / 0.05));
  for (const bool flat : {false, true}) {
    cloth.rest_is_flat = flat;
    double force = 0;
    for (const TriangleBending& row : triangle_bending_elements(cloth, 0)) {
      Element e;
      e.params = row;
      for (const u32 site : row.site) e.x.push_back(cloth.mesh.points[site]);
      e.x0 = e.x;
      force = std::max(force, check.evaluate({e}, false)[0].gradient.cwiseAbs().maxCoeff());
    }
    if (flat)
      EXPECT_GE(force, 1e-5);
    else
      EXPECT_LE(force, 1e-15);
  }
}

}  // namespace
}  // namespace pvg::triangle_bending_test
