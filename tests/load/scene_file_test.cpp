// Scene files with bodies of plain shapes, joints and stitches; every mistake is named with file, line and key.
#include "host/load/scene_file.hpp"

#include <gtest/gtest.h>

#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <numbers>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/load/build_scene.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

const char* const SCENE = R"(schema: 1
name: all
time_step: 50 ms
duration: 2 s
gravity: [0, 0, -9.80665]
bodies:
  - {name: floor, kind: static, shape: {square: {size: 4}}}
  - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, density: 1000, pose: {position: [0.2, 0, 1]}, angular_velocity: [0, 0, 90 deg/s]}
  - {name: ball, kind: rigid, shape: {sphere: {radius: 50 mm}}, mass: 2, collides: false}
  - {name: bar, kind: soft, shape: {bar: {size: [0.1, 0.01, 0.01], divisions: [10, 1, 1], nodes_per_element: 4}}, material: {density: 900, youngs_modulus: 2 MPa, poisson_ratio: 0.45}, pose: {position: [0, 0, 2]}}
joints:
  - {name: slider, type: prismatic, parent: floor, child: cube, parent_frame: {position: [0, 0, 1]}, axis: [2, 0, 0], initial: 0.2, drive: {stiffness: 100, target_times: [0, 1 s, 2 s], target: [0.2, 0.3, 0.1]}}
stitches:
  - {soft: bar, rigid: floor, low: [-0.051, -1, -1], high: [-0.049, 1, 1], stiffness: 1 kN/m, direction: [0, 0, 1]}
pair_friction:
  - {first: floor, second: bar, coefficient: 0.3}
  - {first: towel, second: floor, coefficient: 0.6}
cloths:
  - name: towel
    shape: {sheet: {size: [0.3, 0.2], divisions: [6, 4]}}
    material: {area_density: 300 g/m^2, thickness: 2 mm, stretch_warp: 3000, stretch_weft: 12 N/mm, poisson_ratio: 0.25, bending: 2e-5}
    pinned:
      - {low: [-0.2, -1, -1], high: [-0.14, 1, 1]}
      - {low: [-0.2, 0.09, -1], high: [1, 1, 1]}
    pose: {x: [0.4, 0.6], z: 0.3, yaw: 90 deg}
  - {name: sheet, shape: {disc: {radius: 0.1, rings: 3}}, material: {density: 1000, youngs_modulus: 2 MPa, thickness: 1 mm}, rest_angles: mesh, warp: [0, 1, 0]}
)";

struct SceneFiles : testing::Test {
  fs::path path = fs::temp_directory_path() / ("pvg_scene_file_" + std::to_string(getpid()) + ".yaml");
  ~SceneFiles() override { fs::remove(path); }

  SceneRun load(const std::string& text) {
    std::ofstream(path) << text;
    return load_scene_run(path);
  }
  void expect_refused(const std::string& from, const std::string& to, int line, const std::string& key) {
    expect_refused_in(SCENE, from, to, line, key);
  }
  void expect_refused_in(std::string text, const std::string& from, const std::string& to, int line,
                         const std::string& key) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    try {
      load(text);
      FAIL() << to << " was accepted";
    } catch (const UsageError& e) {
      const std::string message = e.what();
      EXPECT_NE(message.find(path.string() + ":" + std::to_string(line) + ":"), std::string::npos) << message;
      EXPECT_NE(message.find(key), std::string::npos) << message;
    }
  }
};

TEST_F(SceneFiles, HoldBodiesJointsAndStitches) {
  const SceneRun run = load(SCENE);
  const Scene& scene = run.scene;
  ASSERT_EQ(scene.rigid_bodies.size(), 3u);
  EXPECT_TRUE(scene.rigid_bodies[0].is_fixed);
  EXPECT_NEAR(scene.rigid_bodies[1].mass, 1, 1e-12);
  EXPECT_NEAR(scene.rigid_bodies[1].inertia(0, 0), 0.01 / 6, 1e-12);
  EXPECT_NEAR(scene.rigid_bodies[1].angular_velocity.z(), std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(scene.rigid_bodies[2].mass, 2, 1e-12);
  EXPECT_TRUE(scene.rigid_bodies[2].collision.triangles.empty());
  ASSERT_EQ(scene.soft_bodies.size(), 1u);
  EXPECT_EQ(scene.soft_bodies[0].mesh.n_elements(), 60u);
  EXPECT_EQ(scene.soft_bodies[0].material.youngs_modulus, 2e6);
  EXPECT_EQ(scene.stitches.at(0).nodes.size(), 4u);
  EXPECT_EQ(scene.stitches[0].direction, Vec3::UnitZ());
  EXPECT_EQ(scene.gravity.z(), -9.80665);
  EXPECT_EQ(scene.pair_friction.at(0).second, "bar");
  EXPECT_EQ(run.n_steps(), 40u);
  EXPECT_EQ(load_scene(path).joints.size(), 1u);
}

TEST_F(SceneFiles, HoldBodiesOfSeveralPartsAndPairsThatDoNotCollide) {
  std::string text = SCENE;
  text.replace(
      text.find("{box: {size: [0.1, 0.1, 0.1]}}, density: 1000"), 45,
      "{parts: [{shape: {box: {size: [0.2, 0.2, 0.2]}}, position: [1, 0, 0], rotation: [0, 0, 90 deg], size: 0.5},"
      " {shape: {sphere: {radius: 50 mm}}, position: [0, 1, 0]}]}, mass: 3, center_of_mass: [0.5, 0, 0], "
      "inertia: [3, 2, 2, 0.1, 0.2, 0.3]");
  const Scene scene = load(text + "noncolliding: [{first: ball, second: cube}]\n").scene;
  const RigidBody& body = scene.rigid_bodies[1];
  EXPECT_EQ(body.mass, 3);
  EXPECT_EQ(body.center_of_mass, Vec3(0.5, 0, 0));
  EXPECT_EQ(body.inertia(0, 2), 0.2);
  EXPECT_EQ(body.inertia(2, 1), 0.3);
  Vec3 low = Vec3::Constant(9), high = -low;
  for (const Vec3& point : body.collision.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  EXPECT_NEAR(high[0], 1.05, 1e-12);
  EXPECT_NEAR(high[1], 1.05, 1e-3);
  EXPECT_NEAR(low[2], -0.05, 1e-12);
  ASSERT_EQ(scene.noncolliding_rigid_bodies.size(), 1u);
  EXPECT_EQ(scene.noncolliding_rigid_bodies[0], (std::array<int, 2>{2, 1}));
}

TEST_F(SceneFiles, HoldDisplaysOfRigidBodies) {
  std::string text = SCENE;
  const std::string ball = "mass: 2, collides: false";
  text.replace(
      text.find(ball), ball.size(),
      ball + ", display: {position: [0, 0, 50 mm], width: 40 mm, height: 20 mm, resolution: 10 mg, tare: 2 g}");
  EXPECT_THROW(load(text), UsageError);  // mg is no unit of a mass here
  text.replace(text.find("10 mg"), 5, "0.01 g");
  const Scene scene = load(text).scene;
  ASSERT_EQ(scene.displays.size(), 1u);
  EXPECT_EQ(scene.displays[0].name, "ball");
  EXPECT_EQ(scene.displays[0].rigid, 2);
  EXPECT_DOUBLE_EQ(scene.displays[0].resolution, 1e-5);
  EXPECT_DOUBLE_EQ(scene.displays[0].tare, 2e-3);
  EXPECT_DOUBLE_EQ(scene.displays[0].pose.translation().z(), 0.05);
}

TEST_F(SceneFiles, HoldMomentsOfInertia) {
  std::string text = SCENE;
  text.replace(text.find("mass: 2,"), 8, "mass: 2, inertia: [3e-3, 20000 g cm^2, 4e-3],");
  EXPECT_TRUE(load(text).scene.rigid_bodies[2].inertia.isApprox(Mat3(Vec3(3e-3, 2e-3, 4e-3).asDiagonal()), 1e-12));
  EXPECT_EQ(load(text).scene.rigid_bodies[2].mass, load(SCENE).scene.rigid_bodies[2].mass);
}

TEST_F(SceneFiles, HoldCloths) {
  const SceneRun run = load(SCENE);
  ASSERT_EQ(run.scene.cloths.size(), 2u);
  const Cloth &towel = run.scene.cloths[0], &sheet = run.scene.cloths[1];
  EXPECT_EQ(towel.mesh.points.size(), 35u);
  EXPECT_EQ(towel.mesh.triangles.size(), 48u);
  EXPECT_EQ(towel.pinned.size(), 5u + 6u);  // a column and a row that share a point
  EXPECT_NEAR(towel.material.area_density, 0.3, 1e-15);
  EXPECT_EQ(towel.material.stretch_weft, 12000);
  EXPECT_NEAR(towel.material.shear, 6000 / 2.5, 1e-9);  // sqrt(3000 x 12000) / (2 (1 + nu))
  EXPECT_EQ(towel.material.limit_strain, 0.05);
  EXPECT_TRUE(towel.rest_is_flat);
  EXPECT_TRUE((towel.pose * Vec3(0.1, 0, 0)).isApprox(Vec3(0.5, 0.1, 0.3)));
  EXPECT_NEAR(sheet.material.area_density, 1, 1e-15);     // rho t
  EXPECT_NEAR(sheet.material.stretch_warp, 2000, 1e-12);  // E t
  EXPECT_NEAR(sheet.material.bending_weft, 2e6 * 1e-9 / 12, 1e-18);
  EXPECT_FALSE(sheet.rest_is_flat);
  EXPECT_EQ(sheet.warp_direction, Vec3::UnitY());
  EXPECT_EQ(run.scene.pair_friction.at(1).first, "towel");
}

TEST_F(SceneFiles, StitchCloths) {
  const std::string stitch = "{soft: bar, rigid: floor, low: [-0.051, -1, -1], high: [-0.049,";
  std::string text = SCENE;
  text.replace(text.find(stitch), stitch.size(), "{cloth: towel, rigid: floor, low: [0.09, 0.04, -1], high: [0.2,");
  const Stitch held = load(text).scene.stitches.at(0);
  EXPECT_EQ(held.cloth, 0);
  EXPECT_EQ(held.soft, -1);
  EXPECT_EQ(held.nodes, (std::vector<std::uint32_t>{26, 27, 33, 34}));
}

TEST_F(SceneFiles, AJointsFramesMeetAtItsStart) {
  const Joint joint = load(SCENE).scene.joints.at(0);
  EXPECT_EQ(joint.axis, Vec3::UnitX());
  EXPECT_NEAR(joint.child_frame.translation().norm(), 0, 1e-15);
}

TEST_F(SceneFiles, TargetsFollowStraightLines) {
  const SceneRun run = load(SCENE);
  const std::pair<double, double> expected[] = {{0, 0.2}, {0.5, 0.25}, {1, 0.3}, {1.75, 0.15}, {2, 0.1}, {9, 0.1}};
  for (const auto& [time, value] : expected) EXPECT_NEAR(run.targets_at(time).at(0), value, 1e-15) << time;
}

const char* const MOVED = R"(schema: 1
name: moved
time_step: 10 ms
separate: true
bodies:
  - {name: ground, kind: half_space, point: [0, 0, 0.1], normal: [0, 0, 2], friction: 0.2}
  - {name: lift, kind: moving, shape: {square: {size: 1}}, path: [{time: 0, position: [0, 0, 1]}, {time: 2 s, position: [0, 0, 3], rotation: [0, 0, 90 deg]}]}
  - {name: belt, kind: moving, shape: {box: {size: [1, 1, 0.1]}}, pose: {position: [5, 0, 1]}, velocity: [0.5, 0, 0]}
  - {name: cart, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, density: 1000, pose: {position: [9, 0, 1]}}
joints:
  - {name: rail, type: prismatic, parent: ground, child: cart, parent_frame: {position: [9, 0, 0.9]}, axis: [1, 0, 0], limits: [-0.5, 50 cm], limit_stiffness: 1e5, damping: 3, drive: {mode: velocity, damping: 40, effort_limit: 12 N, target_times: [0, 1 s], target: [0, 0.2]}}
)";

TEST_F(SceneFiles, HoldMovingBodiesHalfSpacesLimitsAndDriveModes) {
  const SceneRun run = load(MOVED);
  const Scene& scene = run.scene;
  EXPECT_TRUE(scene.separates_start);
  EXPECT_TRUE(scene.rigid_bodies[0].is_half_space && scene.rigid_bodies[0].is_fixed);
  EXPECT_EQ(scene.rigid_bodies[0].pose.translation().z(), 0.1);
  EXPECT_NEAR((scene.rigid_bodies[0].pose.linear().col(2) - Vec3::UnitZ()).norm(), 0, 1e-15);
  const RigidBody &lift = scene.rigid_bodies[1], &belt = scene.rigid_bodies[2];
  EXPECT_TRUE(lift.is_prescribed && !lift.is_fixed);
  EXPECT_EQ(lift.pose.translation().z(), 1);
  ASSERT_EQ(lift.path.size(), 2u);
  EXPECT_EQ(lift.path[1].time, 2);
  EXPECT_NEAR(lift.path[1].pose.linear()(1, 0), 1, 1e-15);
  EXPECT_EQ(belt.velocity.x(), 0.5);
  const Joint& rail = scene.joints.at(0);
  EXPECT_EQ(rail.lower, -0.5);
  EXPECT_EQ(rail.upper, 0.5);
  EXPECT_EQ(rail.limit_stiffness, 1e5);
  EXPECT_EQ(rail.damping, 3);
  EXPECT_EQ(rail.drive.mode, Drive::Mode::velocity);
  EXPECT_EQ(rail.drive.effort_limit, 12);
  EXPECT_NEAR(run.targets_at(0.5).at(0), 0.1, 1e-15);
}

const char* const EFFECTS = R"(effects:
  - {effect: linear_drag, target: cube, drag: 0.5 N s/m}
  - {effect: joint_coulomb_friction, target: slider, effort: 2}
  - {effect: adhesion, target: bar/floor, energy: 0.1}
)";

TEST_F(SceneFiles, HoldEffects) {
  const std::vector<Effect> effects = load(std::string(SCENE) + EFFECTS).scene.effects;
  ASSERT_EQ(effects.size(), 3u);
  EXPECT_EQ(effects[0].name, "linear_drag");
  EXPECT_EQ(effects[0].parameters, std::vector<double>{0.5});
  EXPECT_EQ(effects[1].parameters, (std::vector<double>{2, 1e-3}));  // the second is what is usual
  EXPECT_EQ(effects[2].target, "bar/floor");
}

TEST_F(SceneFiles, MistakesInEffectsAreNamed) {
  const std::string text = std::string(SCENE) + EFFECTS;
  expect_refused_in(text, "effect: linear_drag", "effect: drag", 28, "effects[0].effect");
  expect_refused_in(text, "drag: 0.5 N s/m", "drag: 0.5 N", 28, "effects[0].drag");
  expect_refused_in(text, "drag: 0.5 N s/m", "drag: -1", 28, "effects[0].drag");
  expect_refused_in(text, "effort: 2", "torque: 2", 29, "effects[1].effort");
  try {
    load(std::string(SCENE) + "effects: [{effect: spin_drag, target: bar, drag: 1}]\n");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("spin_drag: its target must be a rigid body"), std::string::npos);
  }
}

const char* const LAWS = R"yaml(effects:
  - {effect: regressed_effort, target: slider, formula: "c0 * sin(3 * q) + c1 * v * fabs(v)", coefficients: [-0.31, -0.02]}
  - {effect: regressed_force, target: ball, formula: ["c0 * x", "c0 * y", "0"], coefficients: [-0.4]}
  - {effect: regressed_effort, target: slider, formula: 0.5}
)yaml";

void expect_laws(const std::vector<Effect>& effects) {
  ASSERT_EQ(effects.size(), 3u);
  EXPECT_EQ(effects[0].name, "regressed_effort");
  EXPECT_EQ(effects[0].target, "slider");
  EXPECT_EQ(effects[0].formulas, std::vector<std::string>{"c0 * sin(3 * q) + c1 * v * fabs(v)"});
  EXPECT_EQ(effects[0].parameters, (std::vector<double>{-0.31, -0.02}));
  EXPECT_EQ(effects[1].name, "regressed_force");
  EXPECT_EQ(effects[1].formulas, (std::vector<std::string>{"c0 * x", "c0 * y", "0"}));
  EXPECT_EQ(effects[1].parameters, std::vector<double>{-0.4});
  EXPECT_EQ(effects[2].formulas, std::vector<std::string>{"0.5"});
  EXPECT_TRUE(effects[2].parameters.empty());
}

TEST_F(SceneFiles, HoldLawsAndTheirConfigurationHoldsThemToo) {
  expect_laws(load(std::string(SCENE) + LAWS).scene.effects);
  const Task task = load_scene_file(path).task;
  const YAML::Node written = YAML::Load(resolved_yaml(task, build_scene_at_middle(task)))["effects"];
  expect_laws(load(std::string(SCENE) + "effects:\n" + YAML::Dump(written) + "\n").scene.effects);
}

TEST_F(SceneFiles, MistakesInLawsAreNamed) {
  const std::string text = std::string(SCENE) + LAWS;
  expect_refused_in(text, "sin(3 * q)", "sin(3 * z)", 28,
                    "effects[0].formula` cannot be used: effect regressed_effort on slider: formula `c0 * sin(3 * z)");
  expect_refused_in(text, "-0.31, -0.02", "-0.31", 28, "uses c1, but the effect has 1 coefficient");
  expect_refused_in(text, "-0.31, -0.02", "-0.31, 2 N", 28, "effects[0].coefficients");
  expect_refused_in(text, "\"0\"]", "\"0\", \"0\"]", 29, "needs 3 formulas, but has 4");
  expect_refused_in(text, "[\"c0 * x\", \"c0 * y\", \"0\"]", "c0", 29, "effects[1].formula");
  expect_refused_in(text, "formula: 0.5", "formula: 0.5, damping: 1", 30, "damping");
}

TEST_F(SceneFiles, MistakesAreNamed) {
  expect_refused("kind: static", "kind: liquid", 7, "`bodies[0].kind`");
  expect_refused("size: 4", "size: -4", 7, "`bodies[0].shape.square.size`");
  expect_refused("{box: {size: [0.1, 0.1, 0.1]}}", "{square: {size: 1}}", 8, "`bodies[1].shape.square`");
  expect_refused("{box: {size: [0.1, 0.1, 0.1]}}", "{cube: {size: 1}}", 8, "`bodies[1].shape.cube`");
  expect_refused("{box: {size: [0.1, 0.1, 0.1]}}", "{}", 8,
                 "one of: mesh, box, sphere, cylinder, capsule, ellipsoid, link, parts, hexahedron");
  expect_refused("{box: {size: [0.1, 0.1, 0.1]}}", "{box: {size: 1}, sphere: {radius: 1}}", 8, "bodies[1].shape");
  expect_refused("nodes_per_element: 4", "nodes_per_element: 5", 10, "`bodies[3].shape.bar.nodes_per_element`");
  expect_refused("{sphere: {radius: 50 mm}}", "{hexahedron: {corners: [0, 0, 0]}}", 9, "24 numbers");
  expect_refused("density: 1000, ", "", 8, "`density` or `mass`");
  expect_refused("mass: 2,", "mass: 2, inertia: [1e-3, 1e-3, 3e-3],", 9, "above the sum of the two others");
  expect_refused("mass: 2,", "mass: 2, inertia: [0, 1e-3, 1e-3],", 9, "`bodies[2].inertia");
  expect_refused("mass: 2,", "mass: 2, inertia: [2e-3, 2e-3, 2e-3, 3e-3, 0, 0],", 9, "principal moments");
  expect_refused("mass: 2,", "mass: 2, inertia: [2e-3, 2e-3],", 9, "[xx, yy, zz, xy, xz, yz]");
  expect_refused("{sphere: {radius: 50 mm}}", "{parts: []}", 9, "at least one");
  expect_refused("stitches:", "noncolliding: [{first: cube, second: sphere}]\nstitches:", 13, "must name two");
  expect_refused("divisions: [10, 1, 1]", "divisions: [512, 512, 512]", 10, "at most a million");
  expect_refused("{bar: {size: [0.1, 0.01, 0.01], divisions: [10, 1, 1],", "{ball_octant: {radius: 1, divisions: 128,",
                 10, "at most a million");
  expect_refused("90 deg/s", "90 deg", 8, "`bodies[1].angular_velocity`");
  expect_refused("name: ball", "name: cube", 9, "`cube` is taken");
  expect_refused("poisson_ratio: 0.45", "poisson_ratio: 0.5", 10, "poisson_ratio");
  expect_refused("divisions: [10, 1, 1]", "divisions: [10, 1, 0.5]", 10, "divisions");
  expect_refused("child: cube", "child: cub", 12, "`joints[0].child`");
  expect_refused("axis: [2, 0, 0]", "axis: [0, 0, 0]", 12, "`joints[0].axis`");
  expect_refused("axis: [2, 0, 0]", "axis: [2, 0, 0], child_frame: {position: [0.01, 0, 0]}", 12, "child_frame");
  expect_refused("target_times: [0, 1 s, 2 s]", "target_times: [0, 2 s, 1 s]", 12, "target_times");
  expect_refused("low: [-0.051,", "low: [-0.0495,", 14, "`stitches[0].low`");
  expect_refused("second: bar", "second: beam", 16, "beam");
  expect_refused("gravity:", "gravitation:", 5, "`gravitation`");
  expect_refused("soft: bar, rigid", "soft: bar, cloth: towel, rigid", 14, "`soft` body or a `cloth`");
  expect_refused("divisions: [6, 4]", "divisions: [6, 4.5]", 20, "`cloths[0].shape.sheet.divisions`");
  expect_refused("300 g/m^2", "300 g", 21, "`cloths[0].material.area_density`");
  expect_refused("300 g/m^2", "300 g/m^2, density: 150", 21, "`area_density` or");
  expect_refused("stretch_warp: 3000, ", "", 21, "`cloths[0].material.stretch_warp`");
  expect_refused("stretch_warp: 3000", "stretch: 3000", 21, "`cloths[0].material.stretch`");
  expect_refused(", bending: 2e-5", "", 21, "`bending`");
  expect_refused("high: [-0.14, 1, 1]", "high: [-0.16, 1, 1]", 23, "`cloths[0].pinned[0].low`");
  expect_refused("name: sheet", "name: towel", 19, "`towel`");
  expect_refused("rest_angles: mesh", "rest_angles: round", 26, "`cloths[1].rest_angles`");
  expect_refused_in(MOVED, "normal: [0, 0, 2]", "normal: [0, 0, 0]", 6, "`bodies[0].normal`");
  expect_refused_in(MOVED, "{time: 0, pos", "{time: 1, pos", 7, "`bodies[1].path[0].time`");
  expect_refused_in(MOVED, "path: [", "pose: {position: [0, 0, 2]}, path: [", 7, "`bodies[1].pose`");
  expect_refused_in(MOVED, "limits: [-0.5, 50 cm]", "limits: [0.1, 0.5]", 11, "`joints[0].limits`");
  expect_refused_in(MOVED, "limits: [-0.5, 50 cm]", "limits: [0.5]", 11, "`joints[0].limits`");
  expect_refused_in(MOVED, "mode: velocity", "mode: speed", 11, "`joints[0].drive.mode`");
  expect_refused_in(MOVED, "mode: velocity", "mode: velocity, stiffness: 5", 11, "stiffness");
}

TEST_F(SceneFiles, MistakesInPathsOfRobotsAreNamed) {
  const fs::path two_arms = fs::path(PVG_DATA_FOLDER) / "scenes/two_arms.yaml";
  std::string text = read_whole_file(two_arms).value();
  for (std::size_t at = 0; (at = text.find("../", at)) != std::string::npos;) text.replace(at, 3, PVG_DATA_FOLDER "/");
  expect_refused_in(text, "{time: 1 s", "{time: 0", 18, "`robots[0].path[1].time`");
  expect_refused_in(text, "joints: [0, ", "joints: [", 17, "`robots[0].path[0].joints`");
  expect_refused_in(text, "gripper: 40 mm", "hand: 40 mm", 17, "`robots[0].path[0].hand`");
  expect_refused_in(text, "    gripper: " PVG_DATA_FOLDER "/grippers/umi_finray/gripper.yaml\n", "\n", 17,
                    "`robots[0].path[0].gripper`");
  expect_refused_in(text, "name: right", "name: left", 19, "`robots[1].name` `left` is taken");
  expect_refused_in(text, "flange: fr3_link8", "flange: fr3_link8\n      feedforward: friction", 8,
                    "`robots` has `feedforward");
}

}  // namespace
}  // namespace pvg
