// Effects whose law is a formula, in the simulator: against the effects that say the same and against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg::law_effects_test {
namespace {

Effect law(const std::string& name, const std::string& target, const std::vector<std::string>& formulas,
           const std::vector<double>& coefficients = {}) {
  return {name, target, coefficients, formulas};
}

// one for all tests, so that its programs are built once
Device& device() {
  static Device one;
  return one;
}

PhysicalScene with(PhysicalScene scene, const std::vector<Effect>& effects) {
  scene.effects = effects;
  return scene;
}

WorldState run(const PhysicalScene& scene, int n) {
  Simulation simulation(device(), scene);
  for (int i = 0; i < n; ++i) simulation.step(std::vector<double>{});
  return simulation.state();
}

// What the solver leaves, and what rounding of a stiffer body's energy leaves (1e-9 at 1e9 Pa), is below what is
// compared.
double joint_after(const PhysicalScene& scene, int n, const std::vector<Effect>& effects) {
  PhysicalScene precise = with(scene, effects);
  precise.solver.velocity_tolerance = 1e-6;
  for (RigidBody& body : precise.rigid_bodies) body.affine_modulus = 1e7;
  return run(precise, n).joint_position[0];
}

// thrown around its hinge or along its rail
PhysicalScene thrown(PhysicalScene scene) {
  RigidBody& moving = scene.rigid_bodies[1];
  if (scene.joints[0].type == Joint::Type::prismatic) {
    moving.velocity = Vec3(0, 0, 1);
  } else {
    moving.angular_velocity = Vec3(0, 25, 0);
    moving.velocity = moving.angular_velocity.cross(moving.pose.translation() - Vec3(0, 0, 1));
  }
  return scene;
}

TEST(LawEffects, ALinearLawIsTheViscousFrictionOrSpringThatSaysTheSame) {
  for (const PhysicalScene& scene : {thrown(rod_on_hinge(0.5, {})), rod_on_hinge(1, {}), thrown(box_on_rail({}))}) {
    const std::string joint = scene.joints[0].name;
    const double free = joint_after(scene, 100, {});
    const double braked = joint_after(scene, 100, {{"joint_viscous_friction", joint, {0.01}}});
    const double by_law = joint_after(scene, 100, {law("regressed_effort", joint, {"c0*v"}, {-0.01})});
    EXPECT_GT(std::abs(braked - free), 1e-3);
    EXPECT_NEAR(by_law, braked, 1e-9);
    const double sprung = joint_after(scene, 100, {{"joint_spring", joint, {0.3, 0.1}}});
    const double law_of_spring = joint_after(scene, 100, {law("regressed_effort", joint, {"c0 + c1*q"}, {0.1, -0.3})});
    EXPECT_GT(std::abs(sprung - free), 1e-3);
    EXPECT_NEAR(law_of_spring, sprung, 1e-9);
  }
}

// the fast hinge has turned more than once by then: whole turns count
TEST(LawEffects, ALawOfAHingeKnowsWholeTurns) {
  PhysicalScene scene = thrown(rod_on_hinge(0.5, {}));
  EXPECT_GT(joint_after(scene, 100, {law("regressed_effort", "hinge", {"-0.001 * q"})}), 7);
}

// a steep law, as friction is: it stops where Coulomb's friction does, 2 N on 1 kg at 1 m/s
TEST(LawEffects, ASteepLawStopsASlide) {
  PhysicalScene scene = thrown(box_on_rail({}));
  scene.gravity.setZero();
  const double stopped = joint_after(scene, 80, {law("regressed_effort", "rail", {"-2 * tanh(v / 0.002)"})});
  EXPECT_NEAR(stopped, 0.25 - 0.005, 1e-3);
}

TEST(LawEffects, LawsAddUpAndWorldsOfABatchHaveTheirOwn) {
  const PhysicalScene scene = rod_on_hinge(1, {});
  const std::vector<PhysicalScene> worlds = {
      with(scene, {law("regressed_effort", "hinge", {"c0 * v"}, {-0.02})}),
      with(scene, {law("regressed_effort", "hinge", {"c0*v"}, {-0.01})}), scene,
      with(scene, {law("regressed_effort", "hinge", {"c0 * v"}, {-0.01}),
                   law("regressed_effort", "hinge", {"c1 * sin(q)"}, {0, 0.1})})};
  Simulation together(device(), worlds);
  for (int i = 0; i < 60; ++i) together.step(std::vector<std::vector<double>>(worlds.size()));
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    const double q = together.state(w).joint_position[0];
    EXPECT_NEAR(q, run(worlds[w], 60).joint_position[0], 1e-9) << w;
    for (std::size_t other = 0; other < w; ++other)
      EXPECT_GT(std::abs(q - together.state(other).joint_position[0]), 1e-4) << w;
  }
}

PhysicalScene free_box(double time_step) {
  PhysicalScene scene = empty_scene("free", time_step);
  scene.gravity.setZero();
  scene.rigid_bodies = {box_body("box", Vec3::Constant(0.05), 1000, Vec3::Zero())};  // 1 kg
  return scene;
}

Vec3 place(const WorldState& state) { return state.rigid[0].col(3); }

// m v' = -k v:  x = v0 (1 - exp(-k t)) for 1 kg
TEST(LawEffects, AForceIsExactToTheFirstOrderOfTheTimeStep) {
  const auto error = [](double h) {
    PhysicalScene scene = free_box(h);
    scene.rigid_bodies[0].velocity = Vec3(2, 0, 0);
    scene.effects = {law("regressed_force", "box", {"-c0 * vx", "0", "0"}, {3})};
    const Vec3 at = place(run(scene, int(std::lround(0.5 / h))));
    EXPECT_LT(at.tail<2>().norm(), 1e-9);
    return at.x() - 2 * (1 - std::exp(-3 * 0.5)) / 3;
  };
  const double coarse = error(0.01), fine = error(0.005);
  EXPECT_LT(std::abs(coarse), 0.02);
  EXPECT_GT(std::abs(fine), 1e-5);
  EXPECT_NEAR(coarse / fine, 2, 0.05);
}

// the first step from rest moves 1 kg by F h^2, F = 5 (x, y, z) at the centre of mass
TEST(LawEffects, AForceGoesByTheCentreOfMass) {
  PhysicalScene scene = free_box(0.01);
  RigidBody& box = scene.rigid_bodies[0];
  box.pose.translation() = Vec3(0.3, -0.2, 0.1);
  box.center_of_mass = Vec3(0.01, 0, 0);
  scene.effects = {law("regressed_force", "box", {"c0 * x", "c0 * y", "c0 * z"}, {5})};
  const AffineMap after = run(scene, 1).rigid[0];
  const Vec3 centre = after.leftCols<3>() * box.center_of_mass + after.col(3), start(0.31, -0.2, 0.1);
  EXPECT_LT((centre - start - 5e-4 * start).norm(), 1e-9);
}

// at x + h v / 2: a box that flies at 1 m/s through F = 100 x from 0 feels 100 h / 2
TEST(LawEffects, AForceIsThatOfTheMiddleOfTheStep) {
  PhysicalScene scene = free_box(0.01);
  scene.rigid_bodies[0].velocity = Vec3(1, 0, 0);
  scene.effects = {law("regressed_force", "box", {"100 * x", "0", "0"})};
  EXPECT_NEAR(place(run(scene, 1)).x(), 0.01 + 100 * 0.005 * 1e-4, 1e-9);
}

TEST(LawEffects, ForcesOfABatchAreThoseOfEachWorld) {
  const auto box = [](const std::vector<std::string>& formulas, double c) {
    return with(free_box(0.01), {law("regressed_force", "box", formulas, {c})});
  };
  const std::vector<PhysicalScene> worlds = {box({"c0", "0", "0"}, 1), box({"c0", "0", "0"}, 2), free_box(0.01),
                                             box({"0", "c0", "0"}, 2)};
  Simulation together(device(), worlds);
  for (int i = 0; i < 10; ++i) together.step(std::vector<std::vector<double>>(worlds.size()));
  const double way = 55 * 1e-4;  // h^2 (1 + 2 + ... + 10)
  EXPECT_LT((place(together.state(0)) - Vec3(way, 0, 0)).norm(), 1e-9);
  EXPECT_LT((place(together.state(1)) - Vec3(2 * way, 0, 0)).norm(), 1e-9);
  EXPECT_LT(place(together.state(2)).norm(), 1e-12);
  EXPECT_LT((place(together.state(3)) - Vec3(0, 2 * way, 0)).norm(), 1e-9);
}

TEST(LawEffects, ACheckpointGoesOnWithTheSameBits) {
  for (const auto integrator : {SolverSettings::Integrator::implicit_euler, SolverSettings::Integrator::bdf2}) {
    PhysicalScene scene =
        with(thrown(rod_on_hinge(0.5, {})), {law("regressed_effort", "hinge", {"c0 * v + 0.1 * sin(q)"}, {-0.01}),
                                             law("regressed_force", "rod", {"c0 * vz", "0", "-z"}, {0.3})});
    scene.solver.integrator = integrator;
    Simulation through(device(), scene), resumed(device(), scene);
    Checkpoint middle;
    for (int i = 0; i < 60; ++i) {
      if (i == 31) middle = through.checkpoint();
      through.step(std::vector<double>{});
    }
    resumed.restore(middle);
    for (int i = 31; i < 60; ++i) resumed.step(std::vector<double>{});
    EXPECT_EQ(through.state().joint_position, resumed.state().joint_position);
    EXPECT_EQ(through.state().rigid[1], resumed.state().rigid[1]);
  }
}

TEST(LawEffects, RefuseWhatCannotBeALaw) {
  const PhysicalScene scene = rod_on_hinge(0.5, {});
  const auto expect_refused = [&](const Effect& effect, const std::string& sentence) {
    try {
      Simulation simulation(device(), with(scene, {effect}));
      FAIL() << sentence;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(sentence), std::string::npos) << error.what();
    }
  };
  expect_refused(law("regressed_effort", "rod", {"q"}), "its target must be a revolute or prismatic joint");
  expect_refused(law("regressed_force", "hinge", {"x", "y", "z"}), "its target must be a rigid body");
  expect_refused(law("regressed_effort", "hinge", {"q + x"}),
                 "effect regressed_effort on hinge: formula `q + x` is wrong at character 5, `x` is not known");
  expect_refused(law("regressed_effort", "hinge", {"c1 * q"}, {1}), "uses c1, but the effect has 1 coefficient");
  expect_refused(law("regressed_effort", "hinge", {}), "needs 1 formula, but has 0");
  expect_refused(law("regressed_force", "rod", {"x", "y"}), "needs 3 formulas, but has 2");
  expect_refused(law("regressed_force", "rod", {"x", "y", "q"}), "formula `q` is wrong at character 1, `q` is not");
  expect_refused(law("regressed_effort", "hinge", {"q"}, std::vector<double>(33)), "may have 32 coefficients");
  expect_refused(law("regressed_effort", "hinge", {"c0"}, {NAN}), "a coefficient is not finite");
  expect_refused(law("joint_spring", "hinge", {"q"}, {1, 1}), "needs 0 formulas");
}

}  // namespace
}  // namespace pvg::law_effects_test
