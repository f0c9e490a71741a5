// Refined poses against the truth of a synthetic room, and what they are made of.
#include "host/capture/pose_refinement.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <random>

#include "host/render/camera.hpp"
#include "tests/capture/synthetic_room.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

Vec3 some_direction(std::mt19937& random) {
  std::normal_distribution<double> unit(0, 1);
  return Vec3(unit(random), unit(random), unit(random)).normalized();
}

std::vector<Pose> poses_of(const Capture& capture) {
  std::vector<Pose> poses;
  for (const CaptureFrame& frame : capture.frames) poses.push_back(frame.depth_camera.pose);
  return poses;
}

// Each pose is off by so much, in a direction and about an axis of its own.
void disturb(Capture& capture, double shift, double turn, unsigned seed) {
  std::mt19937 random(seed);
  for (CaptureFrame& frame : capture.frames) {
    Pose& pose = frame.depth_camera.pose;
    pose.linear() = Eigen::AngleAxisd(turn, some_direction(random)) * pose.linear();
    pose.translation() += shift * some_direction(random);
  }
}

struct PoseErrors {
  double shift = 0, largest_shift = 0, turn = 0, largest_turn = 0;  // means and largest [m, rad]
};

// but for a motion of all frames together, which no picture tells
PoseErrors errors_of(std::vector<Pose> poses, const std::vector<Pose>& truth) {
  hold_mean(truth, poses);
  PoseErrors e;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double shift = (poses[i].translation() - truth[i].translation()).norm();
    const double turn = Eigen::AngleAxisd(poses[i].linear() * truth[i].linear().transpose()).angle();
    e.shift += shift / double(poses.size());
    e.turn += turn / double(poses.size());
    e.largest_shift = std::max(e.largest_shift, shift);
    e.largest_turn = std::max(e.largest_turn, turn);
  }
  return e;
}

PoseErrors refined_errors(int n, int width, int height, double shift, double turn) {
  const TestFolder folder;
  write_frames(folder.path, n, width, height, some_frame());
  Capture capture = read_capture(folder.path);
  const std::vector<Pose> truth = poses_of(capture);
  disturb(capture, shift, turn, 5);
  const PoseErrors before = errors_of(poses_of(capture), truth);
  Device device;
  FusionSettings fusion;
  if (std::getenv("PVG_VOXEL")) fusion.voxel = std::atof(std::getenv("PVG_VOXEL")) * 1e-3;
  const PoseRefinement refined = refine_poses(device, capture, capture.frames, fusion, {});
  const PoseErrors after = errors_of(refined.poses, truth);
  const auto print = [](const char* when, const PoseErrors& e) {
    std::printf("%s: off by %.2f mm and %.3f degrees on the mean, %.2f mm and %.3f degrees at most\n", when,
                1e3 * e.shift, e.turn * 180 / M_PI, 1e3 * e.largest_shift, e.largest_turn * 180 / M_PI);
  };
  print("given", before);
  print("refined", after);
  std::printf("%d sweeps, %.0f ms of processor time per frame, %.2f mm before, %.2f mm after\n", refined.n_sweeps,
              refined.cpu_ms_per_frame, 1e3 * refined.distance_before, 1e3 * refined.distance_after);
  return after;
}

TEST(PoseRefinement, DisturbedPosesComeBack) {
  const PoseErrors after = refined_errors(12, 320, 240, 0.01, 0.5 * M_PI / 180);
  EXPECT_LE(after.shift, 2e-3);
}

TEST(PoseRefinement, ExactPosesStay) {
  const PoseErrors after = refined_errors(12, 320, 240, 0, 0);
  EXPECT_LE(after.shift, 1e-3);
}

}  // namespace
}  // namespace pvg
