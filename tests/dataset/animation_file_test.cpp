// The animated glTF: where it puts a point of a turned body and of a soft one at a picture, worked out from the file by
// hand.
#include "host/dataset/animation_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "host/base/error.hpp"
#include "host/formats/tinygltf.hpp"
#include "host/geometry/primitive_shapes.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

Scene moving_scene() {
  Scene scene;
  RigidBody door;
  door.name = "door";
  door.collision.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  door.collision.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  scene.rigid_bodies = {door};
  SoftBody pad;
  pad.name = "pad";
  pad.mesh = box_solid(Vec3(1, 1, 1), {2, 2, 2}, 4);
  scene.soft_bodies = {pad};
  return scene;
}

SceneState state_at(const Scene& scene, double time, double angle, const Vec3& shift) {
  SceneState state;
  state.time = time;
  AffineMap map;
  map.leftCols<3>() = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
  map.col(3) = shift;
  state.rigid = {map};
  state.soft = {scene.soft_bodies[0].mesh.points};
  for (Vec3& p : state.soft[0]) p += shift;
  return state;
}

std::vector<float> read(const tinygltf::Model& model, int accessor, std::size_t n) {
  const tinygltf::BufferView& view = model.bufferViews.at(model.accessors.at(accessor).bufferView);
  std::vector<float> values(model.accessors[accessor].count * n);
  EXPECT_EQ(view.byteLength, values.size() * sizeof(float));
  std::memcpy(values.data(), &model.buffers[0].data.at(view.byteOffset), view.byteLength);
  return values;
}

tinygltf::Model written_and_read(AnimationFile& animation) {
  const fs::path file = fs::temp_directory_path() / ("pvg_animation_" + std::to_string(getpid()) + ".glb");
  animation.write(file);
  tinygltf::Model model;
  tinygltf::TinyGLTF loader;
  std::string error, warning;
  EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, file.string())) << error;
  EXPECT_TRUE(warning.empty()) << warning;
  fs::remove(file);
  return model;
}

TEST(AnimationFile, AViewerFindsTheBodiesWhereTheStatesPutThem) {
  const Scene scene = moving_scene();
  AnimationFile animation(scene);
  animation.append(state_at(scene, 0, 0, Vec3::Zero()));
  animation.append(state_at(scene, 0.5, 1.0, Vec3(1, 2, 3)));
  animation.append(state_at(scene, 1.0, 3.5, Vec3(2, 4, 6)));  // more than half a turn
  const tinygltf::Model model = written_and_read(animation);
  ASSERT_EQ(model.nodes.size(), 3u);
  ASSERT_EQ(model.animations.size(), 1u);
  const tinygltf::Animation& motion = model.animations[0];
  EXPECT_EQ(read(model, motion.samplers.at(0).input, 1), (std::vector<float>{0, 0.5f, 1}));
  for (const tinygltf::AnimationChannel& channel : motion.channels) {
    const int output = motion.samplers.at(channel.sampler).output;
    const std::string& name = model.nodes.at(channel.target_node).name;
    if (channel.target_path == "translation") {
      EXPECT_EQ(name, "door");
      EXPECT_EQ(read(model, output, 3), (std::vector<float>{0, 0, 0, 1, 2, 3, 2, 4, 6}));
    } else if (channel.target_path == "rotation") {
      EXPECT_EQ(name, "door");
      const std::vector<float> q = read(model, output, 4);
      const double angles[3] = {0, 1.0, 3.5};  // half of each in a quaternion (x, y, z, w)
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(q[4 * k + 2], std::sin(angles[k] / 2), 1e-6);
        EXPECT_NEAR(q[4 * k + 3], std::cos(angles[k] / 2), 1e-6);
      }
    } else {
      EXPECT_EQ(name, "pad");
      EXPECT_EQ(channel.target_path, "weights");
      EXPECT_EQ(read(model, output, 1), (std::vector<float>{0, 0, 1, 0, 0, 1}));  // one target for each later picture
    }
  }
  EXPECT_EQ(motion.channels.size(), 3u);
  // every displacement of the pad's second target is the shift of the last state; inner points are left out
  const tinygltf::Primitive& pad = model.meshes.at(1).primitives.at(0);
  ASSERT_EQ(pad.targets.size(), 2u);
  const std::vector<float> moved = read(model, pad.targets[1].at("POSITION"), 3);
  ASSERT_EQ(moved.size(), 3 * 26u);  // of 27 points the one in the middle is inside
  for (std::size_t i = 0; i < moved.size(); i += 3) {
    EXPECT_FLOAT_EQ(moved[i], 2);
    EXPECT_FLOAT_EQ(moved[i + 1], 4);
    EXPECT_FLOAT_EQ(moved[i + 2], 6);
  }
}

TEST(AnimationFile, HoldsBodiesThatDoNotCollide) {
  Scene scene = moving_scene();
  scene.passing_surfaces = {{0, scene.rigid_bodies[0].collision}};
  scene.rigid_bodies[0].collision = {};
  AnimationFile animation(scene);
  animation.append(state_at(scene, 0, 0, Vec3(1, 2, 3)));
  const tinygltf::Model model = written_and_read(animation);
  ASSERT_EQ(model.meshes.size(), 2u);
  const auto door =
      std::find_if(model.nodes.begin(), model.nodes.end(), [](const auto& node) { return node.name == "door"; });
  ASSERT_NE(door, model.nodes.end());
  EXPECT_EQ(door->translation, (std::vector<double>{1, 2, 3}));  // also without the motion
}

TEST(AnimationFile, AFolderThatIsNotThereIsNamed) {
  const Scene scene = moving_scene();
  AnimationFile animation(scene);
  animation.append(state_at(scene, 0, 0, Vec3::Zero()));
  EXPECT_THROW(animation.write("/nowhere/at/all.glb"), Failure);
}

}  // namespace
}  // namespace pvg
