// Cloth in the simulator: stretch and bending against numbers by hand, and contact without intersection.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "host/physics/step/simulation.hpp"
#include "tests/physics/energies/cloth_check.hpp"

namespace pvg {
namespace {

RigidBody fixed_body(const std::string& name, const TriangleMesh& mesh = {}) {
  RigidBody body;
  body.name = name;
  body.mass = body.volume = 1;
  body.inertia = Mat3::Identity();
  body.is_fixed = true;
  body.collision = mesh;
  return body;
}

template <class Predicate>
std::vector<std::uint32_t> nodes_where(const Cloth& cloth, const Predicate& is_wanted) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < cloth.mesh.points.size(); ++i)
    if (is_wanted(cloth.mesh.points[i])) nodes.push_back(i);
  return nodes;
}

// Steps until no point of the cloth is faster than `speed` [m/s].
void settle(Simulation& simulation, double h, double speed, int most_steps) {
  for (int i = 0; i < most_steps; ++i) {
    const std::vector<Vec3> before = simulation.state().cloth[0];
    simulation.step(std::vector<double>{});
    double fastest = 0;
    for (std::size_t n = 0; n < before.size(); ++n)
      fastest = std::max(fastest, (simulation.state().cloth[0][n] - before[n]).norm() / h);
    if (fastest < speed) return;
  }
  ADD_FAILURE() << "the cloth did not come to rest";
}

TEST(Cloth, AHangingStripStretchesByItsWeightAsTheStretchStiffnessTells) {
  Device device;
  PhysicalScene scene;
  scene.name = "hanging strip";
  scene.contact.activation_distance = 1e-4;
  scene.solver.time_step = 0.05;
  scene.solver.velocity_tolerance = 1e-7;
  Cloth strip = cloth_sheet(ClothGrid::irregular, 20, 2, 0.01);
  strip.material.area_density = 0.2;
  strip.material.stretch_warp = 100;
  strip.material.stretch_weft = 500;
  strip.pose.linear() = Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()).toRotationMatrix();  // x runs down
  scene.rigid_bodies = {fixed_body("ceiling")};
  const std::vector<std::uint32_t> top = nodes_where(strip, [](const Vec3& x) { return x.x() < 1e-9; });
  scene.stitches = {{-1, 0, top, 1e5}};
  scene.stitches[0].cloth = 0;
  scene.cloths = {strip};
  Simulation simulation(device, scene);
  settle(simulation, 0.05, 1e-6, 300);
  double length = 0;  // of the lower edge's middle point below the start
  for (const std::uint32_t i : nodes_where(strip, [](const Vec3& x) { return x.x() > 0.2 - 1e-9; }))
    length -= simulation.state().cloth[0][i].z() / 3;
  // rho g L^2 / (2 k): 0.4 mm, 0.4 % of strain at the top
  const double expected = 0.2 * 9.81 * 0.2 * 0.2 / (2 * 100);
  EXPECT_NEAR(length - 0.2, expected, 0.01 * expected);
}

// A strip held at x <= 0 and bent by its weight: Gamma = rho g L^3 / B against the solution of the elastica with a
// distributed load (computed by shooting). The held column is narrow, so that the clamp stands where it should: a bent
// edge between cells of width a and c has its moment spread over (a + c) / 2.
struct Deflection {
  double drop, reach;  // of the tip, in parts of L
};
Deflection heavy_cantilever(ClothGrid kind, double gamma, std::uint32_t n) {
  Device device;
  PhysicalScene scene;
  scene.name = "heavy cantilever";
  scene.contact.activation_distance = 1e-6;
  scene.solver.time_step = 0.1;
  scene.solver.velocity_tolerance = 1e-6;
  const double length = 0.2, a = length / n;
  Cloth strip = cloth_sheet(kind, n + 1, 2, a);
  for (Vec3& x : strip.mesh.points)
    x.x() = x.x() < 1e-9 ? -0.05 * a : x.x() < 1.5 * a ? std::max(x.x() - a, 0.0) : x.x() - a;
  strip.material.thickness = 0;
  strip.material.area_density = 0.15;
  strip.material.stretch_warp = strip.material.stretch_weft = 1e4;
  strip.material.shear = 5e3;
  strip.material.bending_warp = strip.material.bending_weft = 0.15 * 9.81 * std::pow(length, 3) / gamma;
  const std::vector<std::uint32_t> held = nodes_where(strip, [](const Vec3& x) { return x.x() < 1e-9; });
  scene.rigid_bodies = {fixed_body("clamp")};
  scene.stitches = {{-1, 0, held, 1e7}};
  scene.stitches[0].cloth = 0;
  scene.cloths = {strip};
  Simulation simulation(device, scene);
  settle(simulation, 0.1, 2e-5, 200);
  Deflection tip{0, 0};
  for (const std::uint32_t i : nodes_where(strip, [&](const Vec3& x) { return x.x() > length - 1e-9; })) {
    tip.drop -= simulation.state().cloth[0][i].z() / (3 * length);
    tip.reach += simulation.state().cloth[0][i].x() / (3 * length);
  }
  return tip;
}

TEST(Cloth, AStripSagsAsTheHeavyElasticaDoes) {
  for (const ClothGrid kind : {ClothGrid::right, ClothGrid::alternating}) {
    const Deflection light = heavy_cantilever(kind, 1, 20), heavy = heavy_cantilever(kind, 10, 20);
    EXPECT_NEAR(light.drop / 0.12347, 1, 0.012) << "grid " << int(kind);
    EXPECT_NEAR(heavy.drop / 0.70020, 1, 0.01) << "grid " << int(kind);
    EXPECT_NEAR(heavy.drop / heavy.reach / 1.06680, 1, 0.015) << "grid " << int(kind);
  }
}

// inner points moved by 0.3 of an edge: the strip is a little too stiff
TEST(Cloth, AStripOfIrregularTrianglesSagsAlmostAsTheHeavyElasticaDoes) {
  EXPECT_NEAR(heavy_cantilever(ClothGrid::irregular, 1, 20).drop / 0.12347, 1, 0.06);
  EXPECT_NEAR(heavy_cantilever(ClothGrid::irregular, 10, 20).drop / 0.70020, 1, 0.03);
}

// ---- contact ------------------------------------------------------------------------------------------------------

// All surfaces of the scene in one list, as the exact test wants them.
bool has_intersection(const PhysicalScene& scene, const SceneState& state) {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> group;
  std::vector<std::uint8_t> collides_with_itself;
  const auto add = [&](const std::vector<Vec3>& x, const std::vector<Triangle>& of_body, bool with_itself) {
    const std::uint32_t first = std::uint32_t(points.size());
    points.insert(points.end(), x.begin(), x.end());
    for (const Triangle& t : of_body) {
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
      group.push_back(std::uint32_t(collides_with_itself.size()));
    }
    collides_with_itself.push_back(with_itself);
  };
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b) {
    std::vector<Vec3> x;
    for (const Vec3& point : scene.rigid_bodies[b].collision.points)
      x.push_back(state.rigid[b].leftCols<3>() * point + state.rigid[b].col(3));
    add(x, scene.rigid_bodies[b].collision.triangles, false);
  }
  for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b)
    add(state.soft[b], scene.soft_bodies[b].mesh.surface, true);
  for (std::size_t b = 0; b < scene.cloths.size(); ++b) add(state.cloth[b], scene.cloths[b].mesh.triangles, true);
  return find_intersection(points, triangles, group, collides_with_itself).has_value();
}

TEST(Cloth, ASquareFallsOverASphereAndComesToRestWithoutIntersection) {
  Device device;
  PhysicalScene scene;
  scene.name = "cloth over a sphere";
  scene.solver.time_step = 0.02;
  scene.solver.velocity_tolerance = 2e-3;
  scene.contact.stiffness = 1e4;  // a light cloth needs no more
  Cloth cloth = cloth_sheet(ClothGrid::right, 12, 12, 0.2 / 12);
  cloth.pose.translation() = Vec3(-0.103, -0.098, 0.045);
  scene.cloths = {cloth};
  scene.rigid_bodies = {fixed_body("sphere", sphere_surface(0.04, 2))};
  Simulation simulation(device, scene);
  const int n_steps = 60;
  std::vector<Vec3> before;
  for (int i = 0; i < n_steps; ++i) {
    before = simulation.state().cloth[0];
    const StepReport report = simulation.step(std::vector<double>{});
    ASSERT_FALSE(has_intersection(scene, simulation.state())) << "step " << i;
    ASSERT_GT(report.min_gap, 0);
  }
  double fastest = 0, lowest = 1, force = 0;
  for (std::size_t n = 0; n < before.size(); ++n) {
    fastest = std::max(fastest, (simulation.state().cloth[0][n] - before[n]).norm() / 0.02);
    lowest = std::min(lowest, simulation.state().cloth[0][n].z());
  }
  for (const ContactForce& contact : simulation.state().contacts)
    if (contact.first != contact.second)
      force += (contact.first == 1 ? 1 : -1) * (contact.normal_force * contact.normal + contact.friction_force).z();
  const double weight = 0.15 * 0.2 * 0.2 * 9.81;
  EXPECT_LT(fastest, 0.02);
  EXPECT_NEAR(force, weight, 0.02 * weight);
  EXPECT_LT(lowest, -0.02);  // the corners hang beside the sphere
}

// Fine folds touch themselves where some of the nodes are coupled by the cloth and others are not: what is left out of
// the preconditioner must not make it indefinite.
TEST(Cloth, ALimpSquareThatFoldsFinelyIsSolved) {
  Device device;
  PhysicalScene scene;
  scene.name = "limp cloth over a sphere";
  scene.solver.time_step = 0.01;
  Cloth cloth = cloth_sheet(ClothGrid::right, 16, 16, 0.0125);
  cloth.material.bending_warp = cloth.material.bending_weft = 1e-7;
  cloth.pose.translation() = Vec3(-0.103, -0.098, 0.045);
  scene.cloths = {cloth};
  scene.rigid_bodies = {fixed_body("sphere", sphere_surface(0.04, 2))};
  Simulation simulation(device, scene);
  for (int i = 0; i < 12; ++i) {
    ASSERT_NO_THROW(simulation.step(std::vector<double>{})) << "step " << i;
    ASSERT_FALSE(has_intersection(scene, simulation.state())) << "step " << i;
  }
}

TEST(Cloth, AStripThatFallsOnEndPilesUpOnItselfAndKeepsItsThickness) {
  Device device;
  PhysicalScene scene;
  scene.name = "piling strip";
  scene.solver.time_step = 0.02;
  scene.solver.velocity_tolerance = 2e-3;
  scene.contact.stiffness = 1e4;  // a light cloth needs no more
  Cloth strip = cloth_sheet(ClothGrid::irregular, 10, 1, 0.02);
  strip.material.thickness = 1e-3;
  strip.pose.linear() = Eigen::AngleAxisd(M_PI / 2 - 0.02, Vec3::UnitY()).toRotationMatrix();  // x runs down
  strip.pose.translation() = Vec3(0, 0, 0.205);
  scene.cloths = {strip};
  scene.rigid_bodies = {fixed_body("floor", square_surface(2))};
  Simulation simulation(device, scene);
  bool touches_itself = false;
  for (int i = 0; i < 20; ++i) {
    const StepReport report = simulation.step(std::vector<double>{});
    ASSERT_FALSE(has_intersection(scene, simulation.state())) << "step " << i;
    ASSERT_GT(report.min_gap, 0) << "step " << i;  // of what is left beside both half thicknesses
    for (const ContactForce& contact : simulation.state().contacts) touches_itself |= contact.first == contact.second;
  }
  double highest = 0;
  for (const Vec3& x : simulation.state().cloth[0]) highest = std::max(highest, x.z());
  EXPECT_TRUE(touches_itself);
  EXPECT_LT(highest, 0.1);
}

// thicker than its triangles are high: neighbours must not push each other apart, far parts must
TEST(Cloth, AThickSheetOfFineTrianglesStaysFlatAloneAndFarApartOnAnother) {
  Device device;
  PhysicalScene scene;
  scene.name = "thick sheets";
  scene.solver.time_step = 0.01;
  Cloth lower = cloth_sheet(ClothGrid::irregular, 6, 6, 0.004);
  lower.material.thickness = 0.006;
  Cloth upper = lower;
  upper.name = "upper";
  upper.pose.translation() = Vec3(0.0011, 0.0007, 0.0075);
  for (std::uint32_t i = 0; i < lower.mesh.points.size(); ++i) lower.pinned.push_back(i);
  scene.cloths = {lower, upper};
  Simulation simulation(device, scene);
  StepReport report;
  for (int i = 0; i < 40; ++i) report = simulation.step(std::vector<double>{});
  double lowest = 1, highest = 0, moved = 0;
  for (std::size_t i = 0; i < lower.mesh.points.size(); ++i) {
    const Vec3 &x = simulation.state().cloth[1][i], x0 = lower.mesh.points[i];
    lowest = std::min(lowest, x.z());
    highest = std::max(highest, x.z());
    moved = std::max(moved, (x - x0 - upper.pose.translation()).head<2>().norm());
    EXPECT_EQ(simulation.state().cloth[0][i], x0);  // pinned
  }
  EXPECT_GT(lowest, 0.006);    // half the thickness of each
  EXPECT_LT(highest, 0.0071);  // within the activation distance of 1 mm
  EXPECT_LT(moved, 1e-4);
}

TEST(Cloth, ATowelUnderLoadStretchesLittleBeyondTheLimit) {
  Device device;
  PhysicalScene scene;
  scene.name = "loaded towel";
  scene.solver.time_step = 0.1;
  scene.solver.velocity_tolerance = 1e-6;
  scene.contact.activation_distance = 1e-4;
  Cloth towel = cloth_sheet(ClothGrid::right, 10, 2, 0.01);
  towel.material.stretch_warp = towel.material.stretch_weft = 100;
  towel.material.area_density = 40;  // as if a load were sewn all over it
  towel.pose.linear() = Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()).toRotationMatrix();  // x runs down
  towel.pinned = nodes_where(towel, [](const Vec3& x) { return x.x() < 1e-9; });
  scene.cloths = {towel};
  Simulation simulation(device, scene);
  settle(simulation, 0.1, 1e-5, 200);
  double length = 0;
  for (const std::uint32_t i : nodes_where(towel, [](const Vec3& x) { return x.x() > 0.1 - 1e-9; }))
    length -= simulation.state().cloth[0][i].z() / 3;
  // tension q(s) = rho g (L - s) = k (e + 3 S (e - 0.05)^2), solved for e and summed over the length
  double expected = 0;
  const int n = 10;  // cells: the load of the last half cell hangs at its end
  for (int i = 0; i < n; ++i) {
    const double tension = 40 * 9.81 * 0.01 * (n - i - 0.5) / 100;
    const double b = 1 - 300 * 0.05 * 2, c = 300 * 0.05 * 0.05 - tension;  // 300 e^2 + b e + c = 0
    const double strain = tension < 0.05 ? tension : (-b + std::sqrt(b * b - 1200 * c)) / 600;
    expected += 0.01 * strain;
  }
  for (const std::uint32_t i : towel.pinned)
    EXPECT_EQ(simulation.state().cloth[0][i], towel.pose * towel.mesh.points[i]);
  EXPECT_NEAR(length - 0.1, expected, 0.01 * expected);
  EXPECT_LT(expected, 0.012);  // 20 % without stiffening
}

// ---- against solids -----------------------------------------------------------------------------------------------

TEST(Cloth, CarriesASoftBlockAndARigidOneWithoutIntersection) {
  Device device;
  PhysicalScene scene;
  scene.name = "blocks on a sheet";
  scene.solver.time_step = 0.02;
  scene.solver.velocity_tolerance = 2e-3;
  scene.contact.stiffness = 1e5;
  Cloth sheet = cloth_sheet(ClothGrid::alternating, 10, 10, 0.02);
  sheet.pinned = nodes_where(
      sheet, [](const Vec3& x) { return std::min(x.x(), x.y()) < 1e-9 || std::max(x.x(), x.y()) > 0.2 - 1e-9; });
  scene.cloths = {sheet};
  SoftBody soft;
  soft.name = "soft";
  soft.mesh = box_solid(Vec3(0.03, 0.03, 0.03), {2, 2, 2}, 4);
  soft.material = {200, 2e4, 0.3};
  soft.pose.translation() = Vec3(0.06, 0.1, 0.0165);
  scene.soft_bodies = {soft};
  RigidBody rigid = fixed_body("rigid", box_surface(Vec3(0.03, 0.03, 0.03)));
  rigid.is_fixed = false;
  rigid.mass = 0.0054;
  rigid.volume = 2.7e-5;
  rigid.inertia = Mat3::Identity() * 0.0054 * 0.0009 / 6;
  rigid.pose.translation() = Vec3(0.14, 0.1, 0.0165);
  scene.rigid_bodies = {rigid};
  Simulation simulation(device, scene);
  double force = 0;
  const int n_steps = 40;
  for (int i = 0; i < n_steps; ++i) {
    ASSERT_GT(simulation.step(std::vector<double>{}).min_gap, 0) << "step " << i;
    ASSERT_FALSE(has_intersection(scene, simulation.state())) << "step " << i;
  }
  for (const ContactForce& contact : simulation.state().contacts)  // body 0 rigid, 1 soft, 2 cloth; on the first
    if (contact.first != contact.second)
      force += (contact.first == 2 ? 1 : -1) * (contact.normal_force * contact.normal + contact.friction_force).z();
  const double weight = 2 * 0.0054 * 9.81;
  EXPECT_NEAR(-force, weight, 0.1 * weight);  // still swaying a little
}

// ---- bad input ----------------------------------------------------------------------------------------------------

TEST(Cloth, WhatCannotBeSimulatedIsNamed) {
  Device device;
  const auto message = [&](const PhysicalScene& scene) -> std::string {
    try {
      Simulation simulation(device, scene);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  PhysicalScene good;
  good.cloths = {cloth_sheet(ClothGrid::right, 2, 2, 0.01)};
  EXPECT_EQ(message(good), "");
  PhysicalScene scene = good;
  scene.cloths[0].material.area_density = 0;
  EXPECT_NE(message(scene).find("cloth sheet: its area density"), std::string::npos);
  scene = good;
  scene.cloths[0].material.poisson_ratio = 1;
  EXPECT_NE(message(scene).find("Poisson's ratio"), std::string::npos);
  scene = good;
  scene.cloths[0].pinned = {9};
  EXPECT_NE(message(scene).find("point 9 is to be pinned"), std::string::npos);
  scene = good;
  std::swap(scene.cloths[0].mesh.triangles[0][0], scene.cloths[0].mesh.triangles[0][1]);
  EXPECT_NE(message(scene).find("opposite ways"), std::string::npos);
  scene = good;
  scene.cloths[0].warp_direction = Vec3::UnitZ();
  EXPECT_NE(message(scene).find("warp direction"), std::string::npos);
  scene = good;
  scene.cloths[0].mesh.points.push_back(Vec3::Zero());
  EXPECT_NE(message(scene).find("belongs to no triangle"), std::string::npos);
  scene = good;
  scene.stitches = {{-1, 0, {0}, 1}};
  scene.rigid_bodies = {fixed_body("clamp")};
  EXPECT_NE(message(scene).find("one soft body or one cloth"), std::string::npos);
}

}  // namespace
}  // namespace pvg
