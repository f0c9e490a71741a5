// Named effects in the simulator, one by one, against what each law gives by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "host/physics/energies/effects.hpp"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg::effects_test {
namespace {

constexpr double G = 9.81;  // [m/s^2]

PhysicalScene free_box(const Vec3& velocity = Vec3::Zero()) {
  PhysicalScene scene = empty_scene("free", 0.01);
  scene.gravity.setZero();
  scene.rigid_bodies = {box_body("box", Vec3::Constant(0.05), 1000, Vec3::Zero())};  // 1 kg
  scene.rigid_bodies[0].velocity = velocity;
  return scene;
}

Joint driven(double stiffness) {
  Joint joint;
  joint.drive.stiffness = stiffness;
  joint.drive.compensates_gravity = false;
  return joint;
}

// one for all tests, so that its programs are built once
Device& device() {
  static Device one;
  return one;
}

// runs `n` steps; the last state
WorldState run(const PhysicalScene& scene, int n, const std::vector<double>& targets = {}) {
  Simulation simulation(device(), scene);
  for (int i = 0; i < n; ++i) simulation.step(targets);
  return simulation.state();
}

Vec3 place(const WorldState& state, std::size_t body = 0) { return state.rigid[body].col(3); }

// a box of 1 kg on a rail along z, held by a drive of 1000 N/m: where it rests after a while
double resting_place(const std::vector<Effect>& effects, double damping = 100) {
  Joint joint = driven(1000);
  joint.drive.damping = damping;
  PhysicalScene scene = box_on_rail(joint);
  scene.effects = effects;
  return run(scene, 100, {0}).joint_position[0];
}

TEST(Effects, RestOnARailAsStaticsSays) {
  EXPECT_NEAR(resting_place({}), -G / 1000, 1e-6);
  EXPECT_NEAR(resting_place({{"payload_mass", "box", {0.5}}}), -1.5 * G / 1000, 1e-6);
  EXPECT_NEAR(resting_place({{"actuator_gain", "rail", {0.5}}}), -2 * G / 1000, 1e-6);
  EXPECT_NEAR(resting_place({{"backlash", "rail", {0.004}}}), -G / 1000 - 0.002, 1e-6);
  EXPECT_NEAR(resting_place({{"joint_spring", "rail", {500, 3}}}), (3 - G) / 1500, 1e-6);
  EXPECT_NEAR(resting_place({{"constant_force", "box", {0, 0, -2}}}), -(G + 2) / 1000, 1e-6);
  EXPECT_NEAR(resting_place({{"gravity_tilt", "scene", {0.3, 0}}}), -G * std::cos(0.3) / 1000, 1e-6);
}

// a rod held level by a drive of 100 N m/rad: it sags by m g l / k, l from the hinge to the centre of mass
TEST(Effects, AnOffsetOfTheCentreOfMassChangesTheSag) {
  const auto sag = [](const std::vector<Effect>& effects) {
    Joint joint = driven(100);
    joint.drive.damping = 5;
    PhysicalScene scene = rod_on_hinge(M_PI / 2, joint);
    scene.solver.time_step = 0.01;
    scene.effects = effects;
    return std::abs(run(scene, 150, {M_PI / 2}).joint_position[0] - M_PI / 2);
  };
  EXPECT_NEAR(sag({}), 0.16 * G * 0.2 / 100, 1e-5);
  EXPECT_NEAR(sag({{"center_of_mass_offset", "rod", {0, 0, -0.1}}}), 0.16 * G * 0.3 / 100, 1e-5);
}

// the implicit step of a viscous law is v1 = v0 / (1 + c h / m), exactly
TEST(Effects, LinearDragSlowsByTheSameFactorEachStep) {
  PhysicalScene scene = free_box(Vec3(1, 0, 0));
  scene.effects = {{"linear_drag", "box", {2}}};
  const double factor = 1 / (1 + 2 * 0.01);
  double x = 0, v = 1;
  for (int i = 0; i < 20; ++i) x += 0.01 * (v *= factor);
  EXPECT_NEAR(place(run(scene, 20)).x(), x, 1e-9);
}

TEST(Effects, QuadraticDragEndsAtTheTerminalSpeed) {
  PhysicalScene scene = free_box();
  scene.gravity = Vec3(0, 0, -G);
  scene.effects = {{"quadratic_drag", "box", {4}}};
  Simulation simulation(device(), scene);
  for (int i = 0; i < 200; ++i) simulation.step(std::vector<double>{});
  const double before = place(simulation.state()).z();
  simulation.step(std::vector<double>{});
  EXPECT_NEAR((before - place(simulation.state()).z()) / 0.01, std::sqrt(G / 4), 1e-6);  // m g = k v^2
}

// a cube of 0.1 m and 1 kg: I = m a^2 / 6
TEST(Effects, SpinDragSlowsByTheSameFactorEachStep) {
  PhysicalScene scene = free_box();
  scene.rigid_bodies[0].angular_velocity = Vec3(0, 0, 2);
  scene.effects = {{"spin_drag", "box", {0.01}}};
  const double factor = 1 / (1 + 0.01 * 0.01 * 6 / 0.01);
  const auto turn_of_last_step = [&](int n) {
    Simulation simulation(device(), scene);
    AffineMap before;
    for (int i = 0; i < n; ++i) {
      before = simulation.state().rigid[0];
      simulation.step(std::vector<double>{});
    }
    const Mat3 turn = simulation.state().rigid[0].leftCols<3>() * before.leftCols<3>().transpose();
    return Eigen::AngleAxisd(turn).angle();
  };
  // affine bodies keep their shape by a stiff spring, so turning is exact to its order only
  EXPECT_NEAR(turn_of_last_step(20) / turn_of_last_step(10), std::pow(factor, 10), 2e-3);
}

double slide_on_rail(const Effect& effect, double speed, int n) {
  PhysicalScene scene = box_on_rail({});
  scene.gravity.setZero();
  scene.rigid_bodies[1].velocity = Vec3(0, 0, speed);
  scene.effects = {effect};
  return run(scene, n).joint_position[0];
}

// 1 m/s against 2 N on 1 kg: it stops after v^2 / (2 a) = 0.25 m, less v h / 2 for the implicit steps
TEST(Effects, CoulombFrictionOfAJointStopsAfterAQuarterMetre) {
  EXPECT_NEAR(slide_on_rail({"joint_coulomb_friction", "rail", {2, 1e-3}}, 1, 80), 0.25 - 0.005, 1e-4);
}

TEST(Effects, ViscousFrictionOfAJointSlowsByTheSameFactorEachStep) {
  double x = 0, v = 1;
  for (int i = 0; i < 20; ++i) x += 0.01 * (v /= 1 + 3 * 0.01);
  EXPECT_NEAR(slide_on_rail({"joint_viscous_friction", "rail", {3}}, 1, 20), x, 1e-8);
}

// A rod lets go from level against friction whose smoothing is a thousandth of the speed that one step gives. By the
// usual tolerance the first correction, from within the smoothing, would count as the last one. M = m g l, I = I_c + m
// l^2.
TEST(Effects, CoulombFrictionLetsGoAtOnceHoweverFineItsSmoothing) {
  PhysicalScene scene = rod_on_hinge(M_PI / 2, {});
  scene.solver.time_step = 0.01;
  scene.solver.velocity_tolerance = 1e-3;
  scene.effects = {{"joint_coulomb_friction", "hinge", {0.05, 1e-5}}};
  const RigidBody& rod = scene.rigid_bodies[1];
  const double inertia = rod.inertia(1, 1) + 0.16 * 0.2 * 0.2, effort = 0.16 * G * 0.2 - 0.05;
  const double turned = std::abs(run(scene, 1).joint_position[0] - M_PI / 2);
  EXPECT_NEAR(turned, effort / inertia * 1e-4, 0.01 * effort / inertia * 1e-4);
}

// far above the Stribeck velocity it slides as by Coulomb's friction alone; below, it is braked harder
TEST(Effects, StribeckFrictionBrakesSlowMotionHarder) {
  const auto lost = [](double extra, double speed) {
    return speed * 0.01 - slide_on_rail({"joint_stribeck_friction", "rail", {1, extra, 0.1, 1e-3}}, speed, 1);
  };
  EXPECT_NEAR(lost(3, 1), lost(0, 1), 1e-10);
  EXPECT_NEAR(lost(0, 0.1), 1 * 1e-4, 1e-9);            // F h^2 / m
  const double v = (0.1 * 0.01 - lost(3, 0.1)) / 0.01;  // at the end of the step
  EXPECT_NEAR(lost(3, 0.1), (1 + 3 * std::exp(-v * v / 0.01)) * 1e-4, 1e-8);
}

TEST(Effects, LagAndDelayReachTheDrive) {
  const auto after = [](const std::vector<Effect>& effects, int n) {
    Joint joint = driven(1e6);
    PhysicalScene scene = box_on_rail(joint);
    scene.gravity.setZero();
    scene.effects = effects;
    return run(scene, n, {0.01}).joint_position[0];
  };
  EXPECT_NEAR(after({}, 6), 0.01, 1e-4);
  EXPECT_NEAR(after({{"actuator_delay", "rail", {0.1}}}, 6), 0, 1e-12);
  // the target rises from 0 to 0.01 over the first step of 10 ms, then stays: two ramps, one after the other
  const auto ramp = [](double t) { return t - 0.05 * (1 - std::exp(-t / 0.05)); };
  EXPECT_NEAR(after({{"actuator_lag", "rail", {0.05}}}, 6), ramp(0.06) - ramp(0.05), 2e-4);
}

// ---- contact ----------------------------------------------------------------------------------------------------

// a box of 1 kg sliding on a half-space with friction 0.5; speed lost in a step at this speed
double braking(const std::vector<Effect>& effects, const Vec3& velocity) {
  PhysicalScene scene = free_box();
  scene.gravity = Vec3(0, 0, -G);
  RigidBody ground;
  ground.name = "ground";
  ground.is_half_space = ground.is_fixed = true;
  ground.friction = 0.5;
  scene.rigid_bodies.push_back(ground);
  scene.contact.friction_lag_passes = -1;
  scene.effects = effects;
  scene.rigid_bodies[0].pose.translation().z() = 0.05 + 2e-4;
  Simulation settling(device(), scene);
  for (int i = 0; i < 60; ++i) settling.step(std::vector<double>{});
  scene.rigid_bodies[0].pose.translation() = place(settling.state());
  scene.rigid_bodies[0].velocity = velocity;
  Simulation sliding(device(), scene);
  sliding.step(std::vector<double>{});
  const Vec3 first = place(sliding.state());
  for (int i = 0; i < 4; ++i) sliding.step(std::vector<double>{});
  const Vec3 before = place(sliding.state());
  sliding.step(std::vector<double>{});
  const Vec3 after = place(sliding.state());
  const double v5 = (after - before).head<2>().norm() / 0.01;
  const double v0 = (first - scene.rigid_bodies[0].pose.translation()).head<2>().norm() / 0.01;
  return (v0 - v5) / (5 * 0.01);  // [m/s^2]
}

TEST(Effects, FrictionDependsOnSpeedAndDirection) {
  EXPECT_NEAR(braking({}, Vec3(1, 0, 0)), 0.5 * G, 0.01 * G);
  // far above 0.02 m/s the change of -0.4 is developed
  EXPECT_NEAR(braking({{"velocity_dependent_friction", "box/ground", {-0.4, 0.02}}}, Vec3(1, 0, 0)), 0.3 * G, 0.01 * G);
  const std::vector<Effect> across = {{"anisotropic_friction", "box/ground", {0.6}}};
  EXPECT_NEAR(braking(across, Vec3(1, 0, 0)), 0.5 * G, 0.01 * G);
  EXPECT_NEAR(braking(across, Vec3(0, 1, 0)), 0.8 * G, 0.01 * G);
}

// what a box that turns about the vertical at 5 rad/s on smooth ground loses of its spin [rad/s^2]
double lost_spin(const std::vector<Effect>& effects) {
  PhysicalScene scene = free_box();
  scene.gravity = Vec3(0, 0, -G);
  RigidBody ground;
  ground.name = "ground";
  ground.is_half_space = ground.is_fixed = true;
  ground.friction = 0;
  scene.rigid_bodies.push_back(ground);
  scene.rigid_bodies[0].friction = 0;
  scene.rigid_bodies[0].pose.translation().z() = 0.05 + 2e-4;
  Simulation settling(device(), scene);
  for (int i = 0; i < 60; ++i) settling.step(std::vector<double>{});
  scene.rigid_bodies[0].pose.translation() = place(settling.state());
  scene.rigid_bodies[0].angular_velocity = Vec3(0, 0, 5);
  scene.effects = effects;
  Simulation spinning(device(), scene);
  const auto spin = [&] {
    const Mat3 before = spinning.state().rigid[0].leftCols<3>();
    spinning.step(std::vector<double>{});
    return Eigen::AngleAxisd(Mat3(spinning.state().rigid[0].leftCols<3>() * before.transpose())).angle() / 0.01;
  };
  spin();  // the normal force is that of the step before: the first step is free
  const double first = spin();
  for (int i = 0; i < 3; ++i) spin();
  return (first - spin()) / 0.04;
}

// 1 kg on an arm of 2 mm: the torque of 9.81 N x 2 mm takes T / I = 11.8 rad/s^2 with I = m a^2 / 6, beside the 0.6 to
// 1.3 rad/s^2 that the implicit step takes from a spin by itself (about (omega h)^2 / 2 of it in a step)
TEST(Effects, RollingResistanceBrakesASpinByTheForceItIsPressedWith) {
  const double by_itself = lost_spin({});
  EXPECT_LT(by_itself, 1.3);
  EXPECT_NEAR(lost_spin({{"rolling_resistance", "box/ground", {0.002, 0.01}}}) - by_itself, G * 0.002 * 6 / 0.01, 0.3);
}

// hung below a ceiling by adhesion: it holds up to 1.5 gamma / d times the area of 0.01 m^2
double hanging_place(double energy) {
  PhysicalScene scene = free_box();
  scene.gravity = Vec3(0, 0, -G);
  scene.rigid_bodies.push_back(fixed_box("ceiling", Vec3(0.2, 0.2, 0.05), Vec3(0, 0, 0.1 + 3e-4)));
  scene.effects = {{"adhesion", "box/ceiling", {energy}}};
  return place(run(scene, 40)).z();
}

TEST(Effects, AdhesionHoldsABoxUnderACeiling) {
  // 9.81 N within 1 mm ask for 0.65 J/m^2 over the top of 0.01 m^2, 0.05 over twice the whole surface of the box, which
  // is the most that its points and edges can stand for
  EXPECT_NEAR(hanging_place(1.3), 0, 1e-3);
  EXPECT_LT(hanging_place(0.03), -0.1);
}

// a box that is pressed into the barrier and let go leaves slower with dissipation
TEST(Effects, DissipationOfContactTakesFromTheRebound) {
  const auto rebound = [](const std::vector<Effect>& effects) {
    PhysicalScene scene = free_box();
    RigidBody ground;
    ground.name = "ground";
    ground.is_half_space = ground.is_fixed = true;
    scene.rigid_bodies.push_back(ground);
    scene.rigid_bodies[0].pose.translation().z() = 0.05 + 1e-4;
    scene.contact.stiffness = 1e5;
    scene.solver.time_step = 1e-3;
    scene.effects = effects;
    const WorldState state = run(scene, 60);
    return place(state).z() - 0.05;
  };
  const double free = rebound({}), braked = rebound({{"contact_dissipation", "box/ground", {3}}});
  EXPECT_GT(free, 5e-3);
  EXPECT_LT(braked, 0.9 * free);
  EXPECT_GT(braked, 0);
}

// ---- soft bodies ------------------------------------------------------------------------------------------------

// one tetrahedron whose three corners at the floor are stitched to a fixed box; the fourth is pulled
TetMesh one_tetrahedron(int nodes) {
  TetMesh mesh;
  mesh.points = {Vec3(0, 0, 0), Vec3(0.02, 0, 0), Vec3(0, 0.02, 0), Vec3(0, 0, 0.05)};
  mesh.nodes_per_element = nodes;
  mesh.elements = {0, 1, 2, 3};
  mesh.surface = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

PhysicalScene pulled_solid(const std::vector<Effect>& effects, double force) {
  PhysicalScene scene = empty_scene("solid", 0.01);
  scene.gravity.setZero();
  scene.rigid_bodies = {fixed_box("base", Vec3(0.05, 0.05, 0.01), Vec3(0, 0, -0.02))};
  SoftBody solid;
  solid.name = "solid";
  solid.mesh = one_tetrahedron(4);
  solid.material = {1000, 1e5, 0.3};
  scene.soft_bodies = {solid};
  Stitch stitch;
  stitch.soft = stitch.rigid = 0;
  stitch.nodes = {0, 1, 2};
  stitch.stiffness = 1e6;
  scene.stitches = {stitch};
  scene.effects = effects;
  if (force != 0) scene.effects.push_back({"constant_force", "solid", {0, 0, force}});
  return scene;
}

double height(const WorldState& state) { return state.soft[0][3].z(); }

TEST(Effects, AFreeSolidIsBrakedByMassProportionalDamping) {
  PhysicalScene scene = pulled_solid({{"mass_proportional_damping", "solid", {5}}}, 0);
  scene.stitches.clear();
  scene.soft_bodies[0].velocity = Vec3(0, 0, 1);
  double x = 0.05, v = 1;
  for (int i = 0; i < 10; ++i) x += 0.01 * (v /= 1 + 5 * 0.01);
  EXPECT_NEAR(height(run(scene, 10)), x, 1e-8);
}

// its longest axis is z, 0.05 long: the tip and the foot, half of it from the middle, move by curvature s^2 / 2
TEST(Effects, ARestShapeErrorBendsTheBody) {
  PhysicalScene scene = pulled_solid({{"rest_shape_error", "solid", {2, -1}}}, 0);
  scene.stitches.clear();
  const Vec3 tip = run(scene, 2).soft[0][3];
  EXPECT_NEAR(tip.x(), 2 * 0.025 * 0.025 / 2, 1e-9);
  EXPECT_NEAR(tip.y(), -1 * 0.025 * 0.025 / 2, 1e-9);
}

// its foot is stitched: the tip is all of its length from there, and the foot stays
TEST(Effects, ARestShapeErrorBendsAHeldBodyFromWhereItIsHeld) {
  const std::vector<Vec3> straight = with_effects(pulled_solid({}, 0)).soft_bodies[0].mesh.points;
  const std::vector<Vec3> bent =
      with_effects(pulled_solid({{"rest_shape_error", "solid", {2, -1}}}, 0)).soft_bodies[0].mesh.points;
  EXPECT_TRUE(bent[3].isApprox(straight[3] + Vec3(2, -1, 0) * (0.05 * 0.05 / 2), 1e-12));
  for (const std::size_t foot : {0, 1, 2}) EXPECT_EQ(bent[foot], straight[foot]);
}

TEST(Effects, AViscousSolidYieldsSlowly) {
  const double elastic = height(run(pulled_solid({}, 4), 200)) - 0.05;
  EXPECT_GT(elastic, 1e-3);
  const auto stretch = [](double viscosity, int n) {
    return height(run(pulled_solid({{"kelvin_voigt_damping", "solid", {viscosity}}}, 4), n)) - 0.05;
  };
  EXPECT_LT(stretch(1e5, 5), 0.3 * elastic);                // 2 eta / E = 2 s
  EXPECT_NEAR(stretch(1e3, 200), elastic, 1e-3 * elastic);  // the end is the same
}

TEST(Effects, AHystereticSolidStopsBeforeTheElasticEnd) {
  const double elastic = height(run(pulled_solid({}, 4), 200)) - 0.05;
  const double dry = height(run(pulled_solid({{"hysteretic_damping", "solid", {0.3, 1e-3}}}, 4), 200)) - 0.05;
  EXPECT_LT(dry, elastic);
  EXPECT_GT(dry, 0.5 * elastic);
}

TEST(Effects, AStiffeningSolidStretchesLess) {
  const double elastic = height(run(pulled_solid({}, 4), 200)) - 0.05;
  EXPECT_LT(height(run(pulled_solid({{"strain_stiffening", "solid", {100}}}, 4), 200)) - 0.05, 0.9 * elastic);
}

TEST(Effects, ARubberStretchesAsItsTermsSay) {
  const auto stretch = [](const std::vector<Effect>& effects) {
    return height(run(pulled_solid(effects, 4), 200)) - 0.05;
  };
  const double elastic = stretch({});
  EXPECT_LT(stretch({{"yeoh_terms", "solid", {100, 0}}}), 0.9 * elastic);
  EXPECT_GT(stretch({{"yeoh_terms", "solid", {-0.5, 0}}}), elastic);
  // half the shear modulus more, the bulk modulus as before
  const double ogden = stretch({{"ogden_term", "solid", {0.5, 4}}});
  EXPECT_LT(ogden, 0.95 * elastic);
  EXPECT_GT(ogden, elastic / 1.5);
  const double logarithm = stretch({{"neo_hookean_logarithm", "solid", {1}}});
  EXPECT_NE(logarithm, elastic);
  EXPECT_NEAR(logarithm, elastic, 0.05 * elastic);  // of the same moduli
}

// what is left of the stretch when the force ends
double left_over(const std::vector<Effect>& effects, double force, int held) {
  Simulation pulled(device(), pulled_solid(effects, force));
  for (int i = 0; i < held; ++i) pulled.step(std::vector<double>{});
  Simulation released(device(), pulled_solid(effects, 1e-9));
  Checkpoint checkpoint = pulled.checkpoint();
  checkpoint.couplings = released.checkpoint().couplings;
  released.restore(checkpoint);
  for (int i = 0; i < 200; ++i) released.step(std::vector<double>{});
  return height(released.state()) - 0.05;
}

TEST(Effects, CreepGrowsWithTimeAndStays) {
  EXPECT_NEAR(left_over({}, 4, 50), 0, 1e-7);
  const std::vector<Effect> creep = {{"creep", "solid", {0.5}}};
  const double brief = left_over(creep, 4, 20), longer = left_over(creep, 4, 80);
  EXPECT_GT(brief, 1e-5);
  EXPECT_GT(longer, 1.5 * brief);
}

TEST(Effects, YieldKeepsWhatIsBeyondItsLimit) {
  const std::vector<Effect> yield = {{"plastic_yield", "solid", {0.05}}};
  EXPECT_NEAR(left_over(yield, 0.5, 50), 0, 1e-7);
  EXPECT_GT(left_over(yield, 8, 50), 1e-3);
}

TEST(Effects, RefuseWhatTheSceneDoesNotHave) {
  PhysicalScene scene = free_box();
  const auto refusal = [&](const Effect& effect) -> std::string {
    scene.effects = {effect};
    try {
      Simulation simulation(device(), scene);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal({"joint_viscous_friction", "hinge", {1}}).find("joint of the scene, but is `hinge`"),
            std::string::npos);
  EXPECT_NE(refusal({"linear_drag", "box", {-1}}).find("drag must be in [0"), std::string::npos);
  EXPECT_NE(refusal({"lubrication", "box", {1}}).find("there is no effect `lubrication`"), std::string::npos);
}

}  // namespace
}  // namespace pvg::effects_test
