// The matrix of an iteration that serves for the next one: fewer Hessians than iterations, the same minimum, and a
// world still does not depend on its companions.
#include <gtest/gtest.h>

#include "host/geometry/primitive_shapes.hpp"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

// a soft bar, one end of which a moving box turns
PhysicalScene turned_bar(double speed, double tolerance) {
  PhysicalScene scene = empty_scene("bar", 0.02);
  scene.solver.velocity_tolerance = tolerance;
  SoftBody bar;
  bar.name = "bar";
  bar.mesh = box_solid(Vec3(0.2, 0.04, 0.04), {4, 2, 2}, 10);
  bar.material = {1000, 1e5, 0.4};
  scene.soft_bodies = {bar};
  RigidBody end = box_body("end", Vec3::Constant(0.03), 1000, Vec3(0.14, 0, 0));
  end.is_prescribed = true;
  end.angular_velocity = Vec3(speed, 0, 0);
  scene.rigid_bodies = {end, fixed_box("base", Vec3::Constant(0.03), Vec3(-0.14, 0, 0))};
  for (const int side : {0, 1}) {
    Stitch stitch;
    stitch.soft = 0;
    stitch.rigid = side;
    for (std::uint32_t i = 0; i < bar.mesh.points.size(); ++i)
      if ((side == 0 ? 1 : -1) * bar.mesh.points[i].x() > 0.099) stitch.nodes.push_back(i);
    scene.stitches.push_back(stitch);
  }
  return scene;
}

struct BarRun {
  std::vector<double> position;
  std::size_t newton = 0, hessians = 0;  // hessians: launches
};

BarRun run_bars(const std::vector<PhysicalScene>& worlds, int steps) {
  Device device;
  Simulation simulation(device, worlds);
  device.count_by_name();
  for (int i = 0; i < steps; ++i) simulation.step(std::vector<std::vector<double>>(worlds.size()));
  const DeviceCountsByName counts = device.counts_by_name();
  BarRun run{simulation.checkpoint().position, simulation.counts().newton, 0};
  for (const auto& [what, n] : counts)
    if (what.find("stable_neo_hookean_10_hessian_all") != std::string::npos) run.hessians += n;
  return run;
}

double largest_apart(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(KeptMatrix, LateIterationsMakeNoHessian) {
  constexpr double TOLERANCE = 1e-3;
  constexpr int STEPS = 3;
  const BarRun kept = run_bars({turned_bar(3, TOLERANCE)}, STEPS), exact = run_bars({turned_bar(3, 1e-7)}, STEPS);
  EXPECT_GT(kept.newton, kept.hessians);
  EXPECT_GE(kept.hessians, std::size_t(STEPS)) << "each step begins with its own";
  // each step ends within the tolerance times its length
  EXPECT_LT(largest_apart(kept.position, exact.position), STEPS * TOLERANCE * 0.02);
}

TEST(KeptMatrix, AWorldIsTheSameBesideOneThatTakesMore) {
  const BarRun alone = run_bars({turned_bar(1, 1e-3)}, 2), other = run_bars({turned_bar(6, 1e-3)}, 2);
  const BarRun both = run_bars({turned_bar(1, 1e-3), turned_bar(6, 1e-3)}, 2);
  EXPECT_NE(alone.newton, other.newton);
  std::vector<double> separate = alone.position;
  separate.insert(separate.end(), other.position.begin(), other.position.end());
  EXPECT_EQ(both.position, separate);
}

}  // namespace
}  // namespace pvg
