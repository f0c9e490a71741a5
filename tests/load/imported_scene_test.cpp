// MJCF and URDF files read as scenes.
#include "host/robot/imported_scene.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/load/scene_file.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

const char* const ARM = R"(<mujoco model="two links">
  <option timestep="0.001"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1" pos="0 0 -2"/>
    <body name="upper" pos="0 0 1" euler="10 20 30">
      <joint name="shoulder" axis="0 1 0" armature="0.02" frictionloss="0.3"/>
      <geom type="box" size="0.05 0.1 0.2" pos="0 0 -0.2"/>
      <body name="lower" pos="0 0 -0.4">
        <inertial pos="0.01 0 -0.1" mass="2" fullinertia="0.03 0.025 0.02 0.001 0 0.002"/>
        <joint name="elbow" axis="0 1 0" pos="0 0 0.1" damping="0.5"/>
        <geom type="capsule" size="0.02 0.1"/>
        <geom type="ellipsoid" size="0.02 0.03 0.04" pos="0 0 -0.2" euler="0 45 0"/>
      </body>
    </body>
  </worldbody>
  <actuator><position joint="shoulder" kp="50" kv="3"/></actuator>
</mujoco>
)";

TEST(ImportedScene, OfMjcfHasItsBodiesJointsDrivesAndEffects) {
  const TestFolder folder;
  const SceneRun run = load_scene_run(folder.write("arm.xml", ARM));
  const Scene& scene = run.scene;
  EXPECT_EQ(scene.name, "two_links");
  EXPECT_EQ(scene.solver.time_step, 0.001);
  ASSERT_EQ(scene.rigid_bodies.size(), 4u);  // and the world, which holds the shoulder
  EXPECT_TRUE(scene.rigid_bodies[0].is_half_space);
  const RigidBody& lower = scene.rigid_bodies[2];
  Mat3 inertia;
  inertia << 0.03, 0.001, 0, 0.001, 0.025, 0.002, 0, 0.002, 0.02;
  EXPECT_EQ(lower.inertia, inertia);
  EXPECT_EQ(lower.center_of_mass, Vec3(0.01, 0, -0.1));
  EXPECT_DOUBLE_EQ(lower.mass, 2);  // from the density, which the shape and the mass give
  ASSERT_EQ(scene.joints.size(), 2u);
  const Joint& shoulder = scene.joints[0];
  EXPECT_EQ(shoulder.armature, 0.02);
  EXPECT_EQ(shoulder.drive.stiffness, 50);
  EXPECT_EQ(shoulder.drive.damping, 3);
  EXPECT_EQ(shoulder.drive.damped_rate, Drive::DampedRate::joint);
  EXPECT_FALSE(shoulder.drive.compensates_gravity);
  EXPECT_EQ(scene.joints[1].damping, 0.5);
  ASSERT_EQ(scene.effects.size(), 1u);
  EXPECT_EQ(scene.effects[0].name, "joint_coulomb_friction");
  // from the tip of the capsule to that of the ellipsoid
  double low = 0, high = 0;
  for (const Vec3& point : lower.collision.points) {
    low = std::min(low, point[2]);
    high = std::max(high, point[2]);
  }
  EXPECT_NEAR(high, 0.12, 1e-12);
  EXPECT_NEAR(low, -0.2 - std::hypot(0.02, 0.04) / std::sqrt(2.0), 1e-3);
  // turned about its own axes x, y, z in this order, as MuJoCo does
  const Mat3 turned =
      (Eigen::AngleAxisd(10 * M_PI / 180, Vec3::UnitX()) * Eigen::AngleAxisd(20 * M_PI / 180, Vec3::UnitY()) *
       Eigen::AngleAxisd(30 * M_PI / 180, Vec3::UnitZ()))
          .toRotationMatrix();
  EXPECT_TRUE(scene.rigid_bodies[1].pose.linear().isApprox(turned, 1e-12));
}

TEST(ImportedScene, TextIsASceneFileThatSaysTheSame) {
  const TestFolder folder;
  const SceneRun imported = load_scene_run(folder.write("arm.xml", ARM));
  const SceneRun written = load_scene_run(folder.write("arm.yaml", imported_scene(folder.path / "arm.xml")));
  ASSERT_EQ(written.scene.rigid_bodies.size(), imported.scene.rigid_bodies.size());
  for (std::size_t b = 0; b < written.scene.rigid_bodies.size(); ++b) {
    EXPECT_EQ(written.scene.rigid_bodies[b].pose.matrix(), imported.scene.rigid_bodies[b].pose.matrix());
    EXPECT_EQ(written.scene.rigid_bodies[b].inertia, imported.scene.rigid_bodies[b].inertia);
  }
  EXPECT_EQ(written.configuration, imported.configuration);
}

TEST(ImportedScene, OfUrdfStandsOnItsBase) {
  const SceneRun run = load_scene_run(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  const Scene& scene = run.scene;
  ASSERT_EQ(scene.joints.size(), 7u);
  ASSERT_EQ(scene.rigid_bodies.size(), 8u);
  EXPECT_TRUE(scene.rigid_bodies[0].is_fixed);
  EXPECT_EQ(scene.rigid_bodies[4].mass, 2.6155955791);
  EXPECT_EQ(scene.joints[3].initial, -0.1518);  // zero is outside of its limits
  EXPECT_FALSE(scene.rigid_bodies[4].collision.points.empty());
}

TEST(ImportedScene, RefusesABodyCalledWorld) {
  const TestFolder folder;
  expect_error<UsageError>(
      [&] {
        imported_scene(folder.write("arm.xml",
                                    "<mujoco><worldbody><body name='world'><freejoint/><geom size='.1'/></body>"
                                    "</worldbody></mujoco>"));
      },
      {"arm.xml", "`world`", "rename"});
}

}  // namespace
}  // namespace pvg
