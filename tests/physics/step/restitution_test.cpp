// Rebound at a stated coefficient: impulses by hand, and bodies that drop.
#include "host/physics/step/restitution.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

MovingBody ball(double mass, const Vec3& velocity) {
  MovingBody body;
  body.mass = mass;
  body.inertia = 0.1 * mass * Mat3::Identity();
  body.before.velocity = body.after.velocity = velocity;
  return body;
}

Meeting meeting(const Vec3& normal, double coefficient) {
  Meeting m;
  m.first = 0;
  m.second = 1;
  m.normal = normal;
  m.coefficient = coefficient;
  return m;
}

// the lighter of two balls comes back: v1' = (m1 - e m2) v / (m1 + m2), v2' = (1 + e) m1 v / (m1 + m2)
TEST(Restitution, TwoBallsPartAsNewtonSays) {
  for (const double e : {0.0, 0.4, 1.0}) {
    const std::vector<MovingBody> bodies = {ball(1, Vec3(3, 0, 0)), ball(2, Vec3::Zero())};
    const auto motion = restituted(bodies, std::vector{meeting(-Vec3::UnitX(), e)}, Vec3::Zero(), 0.001);
    ASSERT_TRUE(motion);
    EXPECT_NEAR((*motion)[0].velocity.x(), (1 - 2 * e) * 3 / 3, 1e-9);
    EXPECT_NEAR((*motion)[1].velocity.x(), (1 + e) * 3 / 3, 1e-9);
  }
}

// A rod hits the floor with its end, half a metre from its centre: the end comes back with e v, the centre with
// v - p / m, p = (1 + e) v / (1/m + r^2 / I)
TEST(Restitution, ARodTurnsWhenItsEndHits) {
  std::vector<MovingBody> bodies = {ball(2, Vec3(0, 0, -1)), ball(0, Vec3::Zero())};
  Meeting m = meeting(Vec3::UnitZ(), 0.6);
  m.point = Vec3(0.5, 0, 0);
  const auto motion = restituted(bodies, std::vector{m}, Vec3::Zero(), 0.001);
  ASSERT_TRUE(motion);
  const double p = 1.6 / (1 / 2.0 + 0.25 / 0.2);
  EXPECT_NEAR((*motion)[0].velocity.z(), -1 + p / 2, 1e-9);
  EXPECT_NEAR((*motion)[0].spin.y(), -0.5 * p / 0.2, 1e-9);
}

// Friction of what is added is mu p sideways, or what ends the sliding if that is less
TEST(Restitution, FrictionFollowsWhatIsAdded) {
  for (const double friction : {0.1, 2.0}) {
    std::vector<MovingBody> bodies = {ball(1, Vec3(1, 0, -2)), ball(0, Vec3::Zero())};
    Meeting m = meeting(Vec3::UnitZ(), 0.5);
    m.friction = friction;
    const auto motion = restituted(bodies, std::vector{m}, Vec3::Zero(), 0.001);
    ASSERT_TRUE(motion);
    EXPECT_NEAR((*motion)[0].velocity.x(), friction > 1 ? 0 : 1 - 0.1 * 3, 1e-9);
  }
}

// What only leans on the other is left alone, what the barrier throws is held back by no more than it pushed
TEST(Restitution, OfBodiesAtRestNothingIsAdded) {
  std::vector<MovingBody> bodies = {ball(1, Vec3::Zero()), ball(0, Vec3::Zero())};
  Meeting m = meeting(Vec3::UnitZ(), 0.9);
  EXPECT_FALSE(restituted(bodies, std::vector{m}, Vec3(0, 0, -9.81), 0.001));
  bodies[0].after.velocity = Vec3(0, 0, 0.5);
  m.impulse = 0.2;
  const auto motion = restituted(bodies, std::vector{m}, Vec3(0, 0, -9.81), 0.001);
  ASSERT_TRUE(motion);
  EXPECT_NEAR((*motion)[0].velocity.z(), 0.3, 1e-9);
}

// A box with contacts at its corners, anyhow moving: it never has more energy than it came with
TEST(Restitution, TheEnergyNeverGrows) {
  std::srand(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<MovingBody> bodies = {ball(1, Vec3::Random()), ball(0, Vec3::Zero())};
    bodies[0].inertia = Vec3(0.02, 0.03, 0.04).asDiagonal();
    bodies[0].before.spin = 5 * Vec3::Random();
    bodies[0].after = bodies[0].before;
    std::vector<Meeting> meetings;
    for (int corner = 0; corner < 4; ++corner) {
      Meeting m = meeting(Vec3::UnitZ(), 0.9);
      m.point = Vec3(corner & 1 ? 0.1 : -0.1, corner & 2 ? 0.1 : -0.1, -0.1);
      m.friction = 0.7;
      meetings.push_back(m);
    }
    const auto energy = [&](const Twist& t) {
      return 0.5 * t.velocity.squaredNorm() + 0.5 * t.spin.dot(bodies[0].inertia * t.spin);
    };
    const auto motion = restituted(bodies, meetings, Vec3::Zero(), 0.001);
    EXPECT_LE(energy(motion ? (*motion)[0] : bodies[0].after), energy(bodies[0].before) * (1 + 1e-9));
  }
}

PhysicalScene dropped_ball(const RigidBody& floor, double height, double coefficient, double time_step) {
  PhysicalScene scene = empty_scene("drop", time_step);
  scene.solver.integrator = SolverSettings::Integrator::bdf2;
  scene.solver.velocity_tolerance = 1e-5;
  RigidBody ball = box_body("ball", Vec3::Constant(0.02), 1000, Vec3(0, 0, height + 0.0205));
  ball.collision = sphere_surface(0.02, 1);
  scene.rigid_bodies = {floor, ball};
  scene.pair_restitution = {{"floor", "ball", coefficient}};
  return scene;
}

RigidBody plane() {
  RigidBody floor;
  floor.name = "floor";
  floor.is_fixed = floor.is_half_space = true;
  floor.mass = floor.volume = 1;
  floor.inertia = Mat3::Identity();
  return floor;
}

// Of a ball that drops: how high it comes again, over the height from which it came, is e^2.
TEST(Restitution, ABallComesBackAsHighAsItsCoefficientSays) {
  Device device;
  const RigidBody box = fixed_box("floor", Vec3(0.2, 0.2, 0.05), Vec3(0, 0, -0.05));
  std::vector<PhysicalScene> worlds;
  std::vector<std::array<double, 2>> cases;
  for (const RigidBody& floor : {plane(), box})
    for (const double e : {0.3, 0.5, 0.7, 0.9})
      for (const double height : {0.1, 0.3}) {
        worlds.push_back(dropped_ball(floor, height, e, 0.002));
        cases.push_back({e, height});
      }
  Simulation simulation(device, worlds);
  std::vector<double> lowest(worlds.size(), 1), highest(worlds.size(), 0), before(worlds.size(), 1);
  std::vector<int> turns(worlds.size(), 0);
  for (int i = 0; i < 260; ++i) {
    const std::vector<StepReport> reports = simulation.step(std::vector<std::vector<double>>(worlds.size()));
    for (std::size_t w = 0; w < worlds.size(); ++w) {
      const double z = simulation.state(w).rigid[1](2, 3) - 0.0205;
      EXPECT_GT(reports[w].min_gap, 0);
      EXPECT_LE(z, cases[w][1] + 1e-9);
      if (turns[w] == 0 && z > before[w]) turns[w] = 1;
      if (turns[w] == 1) highest[w] = std::max(highest[w], z);
      before[w] = z;
    }
  }
  for (std::size_t w = 0; w < worlds.size(); ++w)
    EXPECT_NEAR(std::sqrt(highest[w] / cases[w][1]), cases[w][0], 0.02) << cases[w][1] << " m, world " << w;
}

TEST(Restitution, RefusesPairsThatCannotHaveOne) {
  PhysicalScene scene = rod_on_hinge(0, {});
  const auto refused = [&](const PairRestitution& pair, const char* word) {
    scene.pair_restitution = {pair};
    try {
      restitution_pairs(scene);
      FAIL() << word;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused({"base", "road", 0.5}, "`road`");
  refused({"base", "rod", 0.5}, "`hinge`");
  refused({"base", "base", 0.5}, "never meet");
  refused({"base", "rod", 1.5}, "between 0 and 1");
}

}  // namespace
}  // namespace pvg
