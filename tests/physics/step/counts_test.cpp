// What a step asks of the device: launches, waits and bytes, which are what a discrete GPU's time goes to in small
// scenes. The bounds are just above what was counted, so that a read or a launch more in each iteration shows.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

// a box that slides on the floor beside a hanging rod: contact, friction, a joint
PhysicalScene sliding_box_and_rod() {
  PhysicalScene scene = rod_on_hinge(0.3, Joint{});
  scene.solver.velocity_tolerance = 1e-5;
  RigidBody box = box_body("box", Vec3::Constant(0.05), 1000, Vec3(1, 0, 0.0505));
  box.velocity = Vec3(0.2, 0, 0);
  scene.rigid_bodies.push_back(box);
  scene.rigid_bodies.push_back(fixed_box("floor", Vec3(0.5, 0.5, 0.05), Vec3(1, 0, -0.05)));
  return scene;
}

struct Counted {
  SolverCounts counts;
  double x = 0;  // of the box [m]
  bool runs_host_functions = false;
};

// host_functions: "0" treats the device like one apart from the host;  factor: who factors, the host or the device
Counted run(const char* host_functions, const char* factor) {
  constexpr int WARM_UP = 10, STEPS = 20;
  setenv("PVG_HOST_FUNCTIONS", host_functions, 1);
  Device device;
  unsetenv("PVG_HOST_FUNCTIONS");
  setenv("PVG_FACTOR", factor, 1);
  Simulation simulation(device, sliding_box_and_rod());
  unsetenv("PVG_FACTOR");
  for (int i = 0; i < WARM_UP; ++i) simulation.step(std::vector<double>{});
  simulation.restart_counts();
  for (int i = 0; i < STEPS; ++i) simulation.step(std::vector<double>{});
  EXPECT_GT(simulation.state().contacts.size(), 0u);
  return {simulation.counts(), simulation.state().rigid[2](0, 3), device.info().runs_host_functions};
}

void expect_at_most(const SolverCounts& counts, std::size_t launches, std::size_t waits) {
  const DeviceCounts solving = counts.all - counts.recording;
  EXPECT_GT(counts.newton, 20u);
  EXPECT_LE(counts.newton, 61u);
  EXPECT_LE(solving.launches, launches);
  EXPECT_LE(solving.waits, waits);
}

// Boxes that fall beside each other from three heights: contacts come where none was foreseen.
PhysicalScene falling_boxes() {
  PhysicalScene scene = empty_scene("boxes", 0.01);
  scene.gravity = Vec3(0, 0, -9.81);
  for (int i = 0; i < 3; ++i)
    scene.rigid_bodies.push_back(
        box_body("box " + std::to_string(i), Vec3::Constant(0.02), 1000, Vec3(0.1 * i, 0, 0.021 + 0.01 * i)));
  scene.rigid_bodies.push_back(fixed_box("floor", Vec3(0.5, 0.5, 0.05), Vec3(0, 0, -0.05)));
  return scene;
}

struct Fall {
  std::vector<std::vector<double>> positions;  // after each step
  std::size_t repeated_guesses = 0;
};

Fall fall(const char* host_functions) {
  setenv("PVG_HOST_FUNCTIONS", host_functions, 1);
  Device device;
  unsetenv("PVG_HOST_FUNCTIONS");
  setenv("PVG_FACTOR", "device", 1);
  Simulation simulation(device, falling_boxes());
  unsetenv("PVG_FACTOR");
  Fall fall;
  for (int i = 0; i < 15; ++i) {
    simulation.step(std::vector<double>{});
    fall.positions.push_back(simulation.checkpoint().position);
  }
  fall.repeated_guesses = simulation.counts().repeated_guesses;
  return fall;
}

TEST(Counts, GuessesThatAreNotWaitedForGiveTheSameBits) {
  const Fall waiting = fall("1"), foreseeing = fall("0");
  EXPECT_GT(foreseeing.repeated_guesses, 0u) << "contacts came where none was foreseen";
  EXPECT_LT(foreseeing.repeated_guesses, 4u) << "the others are thought to come";
  EXPECT_EQ(waiting.repeated_guesses, 0u);
  EXPECT_EQ(waiting.positions, foreseeing.positions);
}

double bytes_per_newton(const Counted& counted) {
  const DeviceCounts solving = counted.counts.all - counted.counts.recording;
  return double(solving.bytes) / double(counted.counts.newton);
}

TEST(Counts, StepsAskForFewLaunchesAndWaits) {
  const Counted together = run("1", "host"), apart = run("0", "host"), on_device = run("0", "device");
  // in all 20 steps; a read more in each iteration, of which there are 61, shows
  if (together.runs_host_functions) expect_at_most(together.counts, 1650, 250);
  expect_at_most(apart.counts, 1130, 275);
  expect_at_most(on_device.counts, 1360, 130);
  EXPECT_EQ(together.x, apart.x) << "the same, whether numbers move or not";
  EXPECT_NEAR(on_device.x, together.x, 1e-9);
  // of the matrix, 13 kB here, nothing travels where the device factors
  EXPECT_LE(bytes_per_newton(on_device), 1700);
  EXPECT_GE(bytes_per_newton(apart) - bytes_per_newton(on_device), 12000);
}

}  // namespace
}  // namespace pvg
