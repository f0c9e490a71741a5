// An episode in a folder as generate leaves it, small enough to know its numbers: one arm joint and two fingers that
// slide, six steps of 0.1 s, a picture at the end of every second one.
//   joint of step s: q = s + 1, its target 10 (s + 1); each finger: q = 0.01 (s + 1), its target 0.02 (s + 1)
//   the hand is at x = s + 1, turned by 90 degrees about z; the tool frame 0.5 m along the hand's x; the cup at y = s +
//   1 picture f of the camera is grey, 40 (f + 1). A towel of 3 x 3 points, 1 m apart from (0, 0) on, is at z = s + 1
// The start is what s = -1 says; its picture is grey, 20.
#pragma once
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "host/dataset/packed_episode.hpp"
#include "host/dataset/states_file.hpp"
#include "host/formats/video.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {

inline constexpr int SMALL_WIDTH = 32, SMALL_HEIGHT = 16;

// prefix: of the names of joints and links, such as "left/"
inline Scene small_scene(const std::string& prefix) {
  Scene scene;
  scene.solver.time_step = 0.1;
  for (const std::string& name : {prefix + "hand", std::string("cup")}) {
    RigidBody body;
    body.name = name;
    scene.rigid_bodies.push_back(body);
  }
  for (const char* name : {"joint1", "slide1", "slide2"}) {
    Joint joint;
    joint.name = prefix + name;
    joint.parent = joint.child = 0;
    joint.drive.stiffness = 1;
    scene.joints.push_back(joint);
  }
  Camera camera;
  camera.name = "wrist";
  camera.fx = 300;
  scene.cameras.push_back(camera);
  return scene;
}

// After step s - 1, or at the start for s = 0.
inline WorldState small_state(const Scene& scene, double s) {
  WorldState state;
  state.time = 0.1 * s;
  AffineMap hand = AffineMap::Zero(), cup = AffineMap::Zero();
  hand.leftCols<3>() = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  hand.col(3) = Vec3(s, 0, 0);
  cup.leftCols<3>() = Mat3::Identity();
  cup.col(3) = Vec3(0, s, 0);
  state.rigid = {hand, cup};
  state.joint_position = {s, 0.01 * s, 0.01 * s};
  state.joint_effort = state.joint_stop_effort = state.joint_damping_effort = {0, 0, 0};
  state.body_force.resize(2 + scene.cloths.size());
  for (const Cloth& cloth : scene.cloths) {
    state.cloth.push_back(cloth.mesh.points);
    for (Vec3& point : state.cloth.back()) point.z() = s;
  }
  return state;
}

inline std::vector<std::uint8_t> small_picture(int grey) {
  return std::vector<std::uint8_t>(SMALL_WIDTH * SMALL_HEIGHT * 3, std::uint8_t(grey));
}

// is_filmed: there are pictures; has_towel, has_start: so is the towel, and the start
inline std::filesystem::path write_small_episode(const TestFolder& root, const std::string& folder,
                                                 std::uint64_t number, int n_frames = 3, const std::string& prefix = "",
                                                 bool is_filmed = true, bool has_towel = false,
                                                 bool has_start = false) {
  const char* const summary = R"({"frames_per_second": 5.0, "cameras": {"wrist": {"width": 32, "height": 16}}})";
  const std::filesystem::path path = root.write(folder + "/summary.json", summary).parent_path();
  EpisodeHeader header;
  header.task = "lift_cup";
  header.seed = 7;
  header.episode = number;
  header.objects = {"cup"};
  header.configuration =
      "robot: {urdf: ../robots/arm.urdf}\n"
      "gripper: {base_link: hand, joints: [slide1, slide2], "
      "tool_center: {position: [0.5, 0, 0], quaternion: [0, 0, 0, 1]}}\n";
  Scene scene = small_scene(prefix);
  if (has_towel) {
    header.configuration += "cloths: [{name: towel}]\n";
    scene.cloths.emplace_back().name = "towel";
    for (int point = 0; point < 9; ++point) scene.cloths[0].mesh.points.emplace_back(point % 3, point / 3, 0);
  }
  StatesFile states(path / "states.h5", scene, header, {});
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  if (has_start) states.write_start(small_state(scene, 0), std::span(&pose, is_filmed));
  if (has_start && is_filmed) {
    std::filesystem::create_directories(path / "start");
    VideoWriter start(start_video(path, "wrist"), SMALL_WIDTH, SMALL_HEIGHT, 5);
    start.write(small_picture(20));
    start.finish();
  }
  VideoWriter video(path / "wrist.mp4", SMALL_WIDTH, SMALL_HEIGHT, 5);
  for (int step = 0; step < 2 * n_frames; ++step) {
    const double s = step + 1;
    states.append_step(small_state(scene, s), {}, std::vector<double>{10 * s, 0.02 * s, 0.02 * s});
    if (step % 2 == 0 || !is_filmed) continue;
    pose(0, 3) = s;  // the camera moves
    states.append_frame(std::size_t(step), std::span(&pose, 1));
    video.write(small_picture(40 * (step + 1) / 2));
  }
  states.close();
  if (is_filmed) video.finish();
  return path;
}

}  // namespace pvg
