// What goes wrong is named, retried smaller a bounded number of times, and leaves state and companions untouched.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host/physics/step/simulation_impl.hpp"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

using Kind = StepEvent::Kind;
const std::vector<double> NO_TARGETS;

PhysicalScene falling_box(double speed) {
  PhysicalScene scene = empty_scene("fall", 0.005);
  scene.rigid_bodies = {box_body("cube", Vec3::Constant(0.05), 1000, Vec3(0, 0, 1))};
  scene.rigid_bodies[0].velocity.x() = speed;
  return scene;
}

// One tetrahedron whose base is held and whose tip is drawn through the base by a moving body; nothing collides.
PhysicalScene pierced_tetrahedron() {
  PhysicalScene scene = empty_scene("pierced", 0.005);
  scene.gravity = Vec3::Zero();
  RigidBody base = fixed_box("base", Vec3::Constant(0.01), Vec3(0, 0, -0.1));
  RigidBody hook = box_body("hook", Vec3::Constant(0.01), 1000, Vec3(0, 0, 0.3));
  hook.is_prescribed = true;
  hook.velocity = Vec3(0, 0, -1);
  for (RigidBody* body : {&base, &hook}) body->collision = {};
  scene.rigid_bodies = {base, hook};
  SoftBody soft;
  soft.name = "jelly";
  soft.mesh.points = {Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0), Vec3(0.03, 0.03, 0.1)};
  soft.mesh.elements = {0, 1, 2, 3};
  soft.mesh.nodes_per_element = 4;
  soft.material = {1000, 1e4, 0.3};
  scene.soft_bodies = {soft};
  scene.stitches = {{0, 0, {0, 1, 2}, 1e6}, {0, 1, {3}, 1e6}};
  return scene;
}

StepFailure failure_of(Simulation& simulation, int most_steps) {
  try {
    for (int i = 0; i < most_steps; ++i) simulation.step(std::vector<double>{});
  } catch (const StepFailure& failure) {
    return failure;
  }
  ADD_FAILURE() << "every step was done";
  return {"", {{}}};
}

void expect_names(const std::string& sentence, std::initializer_list<const char*> names) {
  for (const char* name : names) EXPECT_NE(sentence.find(name), std::string::npos) << sentence;
}

TEST(StepFailure, ANumberThatIsNotFiniteIsNamed) {
  Device device;
  Simulation simulation(device, falling_box(std::numeric_limits<double>::infinity()));
  const StepFailure failure = failure_of(simulation, 1);
  ASSERT_EQ(failure.events.size(), 1u);
  EXPECT_EQ(failure.events[0].kind, Kind::not_finite);
  EXPECT_EQ(failure.events[0].body, "cube");
  EXPECT_EQ(failure.events[0].time, 0);
  expect_names(failure.what(), {"not finite", "cube", "fall", " 0 s"});
  EXPECT_EQ(simulation.state().rigid[0].col(3), Vec3(0, 0, 1));
}

TEST(StepFailure, AnInvertedElementIsNamedAndTheStateBeforeItKept) {
  Device device;
  Simulation simulation(device, pierced_tetrahedron());
  const StepFailure failure = failure_of(simulation, 40);
  ASSERT_EQ(failure.events.size(), 1u);
  EXPECT_EQ(failure.events[0].kind, Kind::inverted_element);
  EXPECT_EQ(failure.events[0].body, "jelly");
  EXPECT_EQ(failure.events[0].element, 0);
  // the tip starts 0.1 m above the base and goes down at 1 m/s; it lags a little behind the hook
  EXPECT_NEAR(failure.events[0].time, 0.1, 0.01);
  expect_names(failure.what(), {"inverted element", "jelly", "tetrahedron 0"});
  EXPECT_GT(simulation.state().soft[0][3].z(), 0);
  EXPECT_EQ(simulation.state().time, failure.events[0].time);
}

TEST(StepFailure, AStalledSolveIsNamedAfterABoundedNumberOfRetries) {
  Device device;
  PhysicalScene scene = rod_on_hinge(1.5, {});
  scene.solver.max_newton = 1;
  scene.solver.max_step_halvings = 2;
  Simulation simulation(device, scene);
  const StepFailure failure = failure_of(simulation, 1);
  EXPECT_EQ(failure.events[0].kind, Kind::stalled);
  EXPECT_EQ(failure.events[0].body, "rod");
  EXPECT_EQ(failure.events[0].length, 0.005 / 4);
  expect_names(failure.what(), {"stalled", "rod", "Newton"});
}

TEST(StepFailure, AnExhaustedLineSearchIsNamed) {
  Device device;
  const PhysicalScene scene = falling_box(0);
  Simulation::Impl impl(device, std::span(&scene, 1));
  // the energy is least where the body is: whichever way it goes, it rises
  impl.predicted.node.copy_from(impl.x.node);
  impl.potential.update_sites(impl.predicted);
  impl.potential.begin_step(impl.start, impl.predicted, impl.h(), impl.h());
  impl.contacts.find_candidates(impl.x.site, impl.x.site);
  std::vector<double> up(impl.dx.size(), 0);
  up[2] = 1;
  impl.dx.write(up);
  impl.evaluate({0.0});
  impl.energy = impl.moved_energy;
  impl.certified = {1.0};
  impl.line_search(false);
  ASSERT_EQ(impl.reports[0].events.size(), 1u);
  EXPECT_EQ(impl.reports[0].events[0].kind, Kind::exhausted_line_search);
  EXPECT_EQ(impl.reports[0].events[0].body, "cube");
  EXPECT_FALSE(impl.is_intact[0]);
  EXPECT_EQ(impl.x.node.read(), impl.start.node.read());
}

TEST(StepFailure, ARetiredWorldStaysAndCostsNothing) {
  Device device;
  const PhysicalScene worlds[] = {falling_box(std::numeric_limits<double>::infinity()), falling_box(0.5)};
  Simulation together(device, worlds), alone(device, worlds[1]);
  const std::vector<std::vector<double>> targets(2);
  EXPECT_THROW(together.step(targets), StepFailure);
  together.retire(0);
  alone.step(NO_TARGETS);
  const AffineMap stays = together.state(0).rigid[0];
  for (int i = 0; i < 3; ++i) {
    const std::vector<StepReport> reports = together.step(targets);
    EXPECT_EQ(reports[0].newton, 0);
    EXPECT_GT(reports[1].newton, 0);
    alone.step(NO_TARGETS);
  }
  EXPECT_EQ(together.state(0).rigid[0], stays);
  EXPECT_EQ(together.state(1).rigid[0], alone.state(0).rigid[0]);
}

TEST(StepFailure, AStepThatFailsIsDoneInSmallerOnes) {
  Device device;
  PhysicalScene scene = rod_on_hinge(1.5, {});
  scene.solver.time_step = 0.05;
  scene.solver.max_newton = 4;
  Simulation simulation(device, scene);
  int retries = 0;
  for (int i = 0; i < 10; ++i) {
    const StepReport report = simulation.step(NO_TARGETS);
    retries += report.retries;
    EXPECT_EQ(report.retries > 0, !report.events.empty());
  }
  EXPECT_GT(retries, 0);
  EXPECT_NEAR(simulation.state().time, 0.5, 1e-12);
}

// World 0 has to halve its steps, world 2 cannot be simulated at all: world 1 must not notice, world 0 must do as
// alone.
TEST(StepFailure, OfOneWorldDoesNotChangeItsCompanions) {
  Device device;
  for (const auto integrator : {SolverSettings::Integrator::implicit_euler, SolverSettings::Integrator::bdf2}) {
    PhysicalScene hard = rod_on_hinge(1.5, {}), easy = falling_box(1), hopeless = falling_box(INFINITY);
    for (PhysicalScene* scene : {&hard, &easy, &hopeless}) {
      scene->solver.time_step = 0.05;
      scene->solver.max_newton = 4;
      scene->solver.integrator = integrator;
    }
    Simulation together(device, std::vector<PhysicalScene>{hard, easy, hopeless}), first(device, hard),
        second(device, easy);
    for (int i = 0; i < 10; ++i) {
      try {
        together.step(std::vector<std::vector<double>>(3));
        FAIL() << "the hopeless world was stepped";
      } catch (const StepFailure& failure) {
        ASSERT_EQ(failure.events.size(), 1u);
        EXPECT_EQ(failure.events[0].world, 2u);
      }
      first.step(NO_TARGETS);
      second.step(NO_TARGETS);
    }
    EXPECT_EQ(together.state(0).rigid[1], first.state().rigid[1]);
    EXPECT_EQ(together.state(1).rigid[0], second.state().rigid[0]);
    EXPECT_EQ(together.state(1).time, second.state().time);
    EXPECT_EQ(together.state(2).time, 0);
  }
}

}  // namespace
}  // namespace pvg
