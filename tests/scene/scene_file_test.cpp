// Scene files with bodies of plain shapes, joints and stitches; every mistake is named with file, line and key.
#include "host/scene/scene_file.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <numbers>

#include "host/base/error.hpp"
#include "host/scene/build_scene.hpp"

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
)";

struct SceneFiles : testing::Test {
  fs::path path = fs::temp_directory_path() / ("pvg_scene_file_" + std::to_string(getpid()) + ".yaml");
  ~SceneFiles() override { fs::remove(path); }

  SceneRun load(const std::string& text) {
    std::ofstream(path) << text;
    return load_scene_run(path);
  }
  void expect_refused(const std::string& from, const std::string& to, int line, const std::string& key) {
    std::string text = SCENE;
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

TEST_F(SceneFiles, MistakesAreNamed) {
  expect_refused("kind: static", "kind: liquid", 7, "`bodies[0].kind`");
  expect_refused("size: 4", "size: -4", 7, "`bodies[0].shape.square.size`");
  expect_refused("{box: {size: [0.1, 0.1, 0.1]}}", "{square: {size: 1}}", 8, "`bodies[1].shape.square`");
  expect_refused("density: 1000, ", "", 8, "`density` or `mass`");
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
}

}  // namespace
}  // namespace pvg
