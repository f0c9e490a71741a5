// The layout of Microsoft's 7-Scenes: one depth camera of the Kinect, whose colour camera is not registered to it.
#include <algorithm>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/capture/layouts.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

const std::string DEPTH = ".depth.png", POSE = ".pose.txt";

// of the files that end so
std::vector<std::string> frame_names(const fs::path& folder, const std::string& ending = DEPTH) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    if (file.ends_with(ending)) names.push_back(file.substr(0, file.size() - ending.size()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

Pose read_pose_file(const fs::path& file) {
  const std::vector<double> m = numbers_in(file);
  if (m.size() != 16) throw UsageError(file.string() + ": a pose is 16 numbers, the rows of a 4 x 4 matrix");
  Pose pose;
  for (int i = 0; i < 16; ++i) pose.matrix()(i / 4, i % 4) = m[std::size_t(i)];
  return pose;
}

}  // namespace

bool is_seven_scenes(const fs::path& folder) { return !frame_names(folder).empty(); }

Capture read_seven_scenes(const fs::path& folder) {
  const fs::path intrinsics = folder / "camera-intrinsics.txt";
  if (!is_file(intrinsics))
    throw UsageError(intrinsics.string() + " is missing: nine numbers, the rows of the depth camera's 3 x 3 matrix");
  const std::vector<double> K = numbers_in(intrinsics);
  if (K.size() != 9) throw UsageError(intrinsics.string() + ": must hold nine numbers, the rows of a 3 x 3 matrix");
  Capture capture;
  capture.colors_are_apart = true;
  for (const std::string& name : frame_names(folder)) {
    const fs::path pose = folder / (name + POSE);
    if (!is_file(pose)) {
      capture.left_out.push_back(name);
      continue;
    }
    CaptureFrame frame;
    frame.name = name;
    frame.depth = folder / (name + DEPTH);
    for (const char* ending : {".color.jpg", ".color.png"})
      if (frame.color.empty() && is_file(folder / (name + ending))) frame.color = folder / (name + ending);
    Camera& camera = frame.depth_camera;
    camera.fx = K[0];
    camera.cx = K[2];
    camera.fy = K[4];
    camera.cy = K[5];
    camera.pose = read_pose_file(pose);
    frame.color_camera = camera;
    set_size_of(frame.depth, camera);
    set_size_of(frame.color.empty() ? frame.depth : frame.color, frame.color_camera);
    capture.frames.push_back(std::move(frame));
  }
  if (capture.frames.empty())
    throw UsageError(folder.string() + ": none of " + counted(capture.left_out.size(), "frame") +
                     " has a pose; frame-N.pose.txt must stand beside frame-N.depth.png");
  for (const std::string& name : frame_names(folder, POSE))
    if (!is_file(folder / (name + DEPTH))) capture.left_out.push_back(name);
  return capture;
}

}  // namespace pvg
