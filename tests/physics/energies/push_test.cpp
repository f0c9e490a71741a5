// The effect `push`: known forces and torques on a body for a while
#include <gtest/gtest.h>

#include <cmath>

#include "host/physics/energies/effects.hpp"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg::push_test {
namespace {

PhysicalScene free_box() {
  PhysicalScene scene = empty_scene("free", 0.01);
  scene.gravity.setZero();
  scene.rigid_bodies = {box_body("box", Vec3::Constant(0.05), 1000, Vec3::Zero())};  // 1 kg
  return scene;
}

Device& device() {
  static Device one;
  return one;
}

Vec3 place(const WorldState& state) { return state.rigid[0].col(3); }

// 2 N on 1 kg for 0.104 s, which begins and ends within steps: the impulse is exact, and the way to first order in h
TEST(Push, GivesItsImpulse) {
  for (const auto integrator : {SolverSettings::Integrator::implicit_euler, SolverSettings::Integrator::bdf2}) {
    PhysicalScene scene = free_box();
    scene.solver.integrator = integrator;
    scene.effects = {{"push", "box", {0.103, 0.207, 2, 0, 0, 0, 0, 0, 0, 0, 0}}};
    Simulation simulation(device(), scene);
    AffineMap before;
    for (int i = 0; i < 40; ++i) {
      before = simulation.state().rigid[0];
      simulation.step(std::vector<double>{});
    }
    const double speed = (place(simulation.state()).x() - before.col(3).x()) / 0.01;
    EXPECT_NEAR(speed, 0.208, 1e-6);
    EXPECT_NEAR(place(simulation.state()).x(), 0.208 * (0.4 - 0.155), 0.208 * 0.006);
  }
}

// a cube of 0.1 m and 1 kg, I = m a^2 / 6, pushed at 0.05 m from its centre, and by a torque of the same size the other
// way
TEST(Push, BesideTheCentreTurnsAndATorqueTurnsBack) {
  const auto turn_by = [](double force, double torque) {
    PhysicalScene scene = free_box();
    scene.effects = {{"push", "box", {0, 0.05, force, 0, 0, 0, 0, torque, 0, 0.05, 0}}};
    Simulation simulation(device(), scene);
    for (int i = 0; i < 10; ++i) simulation.step(std::vector<double>{});
    const Mat3 turn = simulation.state().rigid[0].leftCols<3>();
    return std::atan2(turn(1, 0), turn(0, 0));
  };
  const double expected = -1 * 0.05 / (0.01 / 6) * 0.05 * (0.1 - 0.025);  // torque / I, time, time since the middle
  EXPECT_NEAR(turn_by(1, 0), expected, 0.1 * std::abs(expected));
  EXPECT_NEAR(turn_by(0, -0.05), expected, 0.1 * std::abs(expected));
  EXPECT_NEAR(turn_by(1, 0.05), 0, 2e-3 * std::abs(expected));
}

}  // namespace
}  // namespace pvg::push_test
