// Refined poses against the truth of a synthetic room, and what they are made of.
#include "host/capture/pose_refinement.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <random>

#include "host/formats/picture_files.hpp"
#include "host/render/camera.hpp"
#include "tests/capture/depth_camera.hpp"
#include "tests/capture/synthetic_room.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

constexpr double DEGREES = 180 / M_PI;

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
    const Pose color_in_depth = pose.inverse() * frame.color_camera.pose;
    pose.linear() = Eigen::AngleAxisd(turn, some_direction(random)) * pose.linear();
    pose.translation() += shift * some_direction(random);
    frame.color_camera.pose = pose * color_in_depth;
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

// mean distance of the fused surface's points from the boxes [m]
double surface_error(Device& device, const Capture& capture, std::span<const Pose> poses,
                     const FusionSettings& settings, const Pose& to_boxes) {
  std::vector<CaptureFrame> frames = capture.frames;
  apply_poses(poses, frames);
  Box box;
  for (const CaptureFrame& f : frames) box.add(seen_box(f.depth_camera, depth_of(capture, f), settings.max_depth));
  Fusion fusion(device, settings, box);
  for (const CaptureFrame& f : frames) fusion.mark(f.depth_camera, depth_of(capture, f));
  fusion.allocate();
  for (const CaptureFrame& f : frames) fusion.integrate(f.depth_camera, depth_of(capture, f));
  const FusedSurface surface = fusion.surface();
  double mean = 0;
  for (const Vec3f& p : surface.points)
    mean += distance_to_room(to_boxes * p.cast<double>()) / double(surface.points.size());
  return mean;
}

struct Refined {
  PoseErrors before, after;
  double surface_before = 0, surface_after = 0;  // mean distance from the boxes [m]
};

Refined refine_synthetic_room(double shift, double turn, bool has_photos = false) {
  const TestFolder folder;
  write_frames(folder.path, 12, 320, 240, some_frame(), has_photos);
  Capture capture = read_capture(folder.path);
  const std::vector<Pose> truth = poses_of(capture);
  disturb(capture, shift, turn, 5);
  std::vector<Pose> given = poses_of(capture);
  Device device;
  FusionSettings settings;
  settings.voxel = 0.008;
  PoseRefinement refined = refine_poses(device, capture, capture.frames, settings, {});
  EXPECT_TRUE(refined.unrefined.empty());
  if (has_photos) {
    const PoseErrors e = errors_of(refined.poses, truth);
    std::printf("by depth alone off by %.2f mm and %.3f degrees on the mean, %.2f mm and %.3f degrees at most\n",
                1e3 * e.shift, e.turn * DEGREES, 1e3 * e.largest_shift, e.largest_turn * DEGREES);
    std::vector<CaptureFrame> frames = capture.frames;
    apply_poses(refined.poses, frames);
    refine_with_photos(device, capture, frames, given, settings, {}, refined);
    std::printf("photos disagree by %.4f before, %.4f after\n", refined.disagreement_before,
                refined.disagreement_after);
  }
  Refined out{errors_of(given, truth), errors_of(refined.poses, truth)};
  // the surfaces where the truth is, but for the motion of all frames together
  std::vector<Pose> poses = refined.poses;
  hold_mean(truth, poses);
  hold_mean(truth, given);
  const Pose to_boxes = some_frame().inverse();
  out.surface_before = surface_error(device, capture, given, settings, to_boxes);
  out.surface_after = surface_error(device, capture, poses, settings, to_boxes);
  for (const auto& [e, surface] : {std::pair{out.before, out.surface_before}, {out.after, out.surface_after}})
    std::printf("off by %.2f mm and %.3f degrees on the mean, %.2f mm and %.3f degrees at most; surface %.2f mm\n",
                1e3 * e.shift, e.turn * DEGREES, 1e3 * e.largest_shift, e.largest_turn * DEGREES, 1e3 * surface);
  std::printf("%d sweeps, %.0f ms of processor time per frame, %.2f mm before, %.2f mm after\n", refined.n_sweeps,
              refined.cpu_ms_per_frame, 1e3 * refined.distance_before, 1e3 * refined.distance_after);
  return out;
}

TEST(PoseRefinement, PosesThatAreTenMillimetresOffComeBack) {
  const Refined r = refine_synthetic_room(0.01, 0.5 / DEGREES);
  EXPECT_LE(r.after.shift, 2.5e-3);
  EXPECT_LE(r.after.turn, 0.15 / DEGREES);
  EXPECT_LE(r.surface_after, 0.6 * r.surface_before);
}

TEST(PoseRefinement, ExactPosesAreMadeLittleWorse) {
  const Refined r = refine_synthetic_room(0, 0);
  EXPECT_LE(r.after.shift, 1.2e-3);
  EXPECT_LE(r.after.turn, 0.05 / DEGREES);
  EXPECT_LE(r.surface_after, r.surface_before + 0.2e-3);
}

// Depth alone leaves 1.86 mm and 0.110 degrees of these.
TEST(PoseRefinement, PhotosBringThemNearer) {
  const Refined r = refine_synthetic_room(0.01, 0.5 / DEGREES, true);
  EXPECT_LE(r.after.shift, 1.2e-3);
  EXPECT_LE(r.after.turn, 0.06 / DEGREES);
}

// of the plane z = 0
DepthPicture wall_seen_by(const Camera& camera) {
  DepthPicture picture{camera.width, camera.height, {}};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vec3 ray = camera.pose.linear() * Vec3((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
      picture.depth.push_back(float(-camera.pose.translation().z() / ray.z()));
    }
  return picture;
}

// of the pattern on it
Picture8 photo_of_wall(const Camera& camera, const DepthPicture& depths) {
  Picture8 photo{camera.width, camera.height, {}};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const double z = double(depths.depth[std::size_t(y * camera.width + x)]);
      const Vec3 p = camera.pose * Vec3((x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z);
      photo.rgb.insert(photo.rgb.end(), 3, std::uint8_t(std::lround(180 * wave_pattern(p))));
    }
  return photo;
}

// Frames in the layout of 7-Scenes of a wall at z = 0, with a Kinect's noise.
Capture wall_capture(const TestFolder& folder, const std::vector<Camera>& cameras, bool has_photos = false) {
  std::mt19937 random(2);
  const Camera& c = cameras.front();
  std::ofstream(folder.path / "camera-intrinsics.txt")
      << c.fx << " 0 " << c.cx << "\n0 " << c.fy << ' ' << c.cy << "\n0 0 1\n";
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string name = "frame-00000" + std::to_string(i);
    const DepthPicture depths = wall_seen_by(cameras[i]);
    write_depth_picture(folder.path / (name + ".depth.png"), with_kinect_noise(depths, random), 1e-3);
    if (has_photos) write_picture(folder.path / (name + ".color.png"), photo_of_wall(cameras[i], depths));
    std::ofstream pose(folder.path / (name + ".pose.txt"));
    pose.precision(17);
    pose << cameras[i].pose.matrix() << '\n';
  }
  return read_capture(folder.path);
}

std::vector<Camera> cameras_before_a_wall() {
  std::vector<Camera> cameras;
  for (int i = 0; i < 5; ++i)
    cameras.push_back(camera_at({0.12 * (i - 2), 0.1 * (i % 2), -0.9 - 0.1 * (i % 3)}, {0.05 * (2 - i), 0.05, 0}));
  return cameras;
}

// A wall alone tells the distance from it and two of the angles. Along the wall and about its normal frames stay where
// they were given, whatever the noise says.
TEST(PoseRefinement, AWallMovesAPictureOnlyToItselfAndNotAlongItself) {
  const TestFolder folder;
  Capture capture = wall_capture(folder, cameras_before_a_wall());
  const std::vector<Pose> truth = poses_of(capture);
  disturb(capture, 0.01, 0.5 / DEGREES, 9);
  const std::vector<Pose> given = poses_of(capture);
  Device device;
  const PoseRefinement refined = refine_poses(device, capture, capture.frames, {}, {});
  double along = 0, about = 0, toward_before = 0, toward_after = 0;
  std::vector<Pose> given_held = given, refined_held = refined.poses;
  hold_mean(truth, given_held);
  hold_mean(truth, refined_held);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vec3 moved = refined.poses[i].translation() - given[i].translation();
    const Eigen::AngleAxisd turned(refined.poses[i].linear() * given[i].linear().transpose());
    along = std::max(along, moved.head<2>().norm());
    about = std::max(about, std::abs(turned.angle() * turned.axis().z()));
    // where the middle of the picture lies
    const Vec3 middle(0, 0, wall_seen_by(cameras_before_a_wall()[i]).depth[60 * 160 + 80]);
    toward_before = std::max(toward_before, std::abs((given_held[i] * middle - truth[i] * middle).z()));
    toward_after = std::max(toward_after, std::abs((refined_held[i] * middle - truth[i] * middle).z()));
  }
  std::printf("along %.3f mm, about %.4f degrees; toward the wall %.2f mm off before, %.2f mm after\n", 1e3 * along,
              about * DEGREES, 1e3 * toward_before, 1e3 * toward_after);
  EXPECT_LE(along, 0.8e-3);
  EXPECT_LE(about, 0.06 / DEGREES);
  EXPECT_LE(toward_after, 0.3 * toward_before);
}

// Depth leaves where along the wall it was given, and the turn about its normal.
TEST(PoseRefinement, PhotosTellWhereOnAWallAPictureIs) {
  const TestFolder folder;
  Capture capture = wall_capture(folder, cameras_before_a_wall(), true);
  const std::vector<Pose> truth = poses_of(capture);
  disturb(capture, 0.01, 0.5 / DEGREES, 9);
  const std::vector<Pose> given = poses_of(capture);
  Device device;
  PoseRefinement refined = refine_poses(device, capture, capture.frames, {}, {});
  std::vector<CaptureFrame> frames = capture.frames;
  apply_poses(refined.poses, frames);
  const PoseErrors by_depth = errors_of(refined.poses, truth);
  refine_with_photos(device, capture, frames, given, {}, {}, refined);
  const PoseErrors by_both = errors_of(refined.poses, truth);
  std::printf("by depth off by %.2f mm and %.3f degrees, with photos by %.2f mm and %.3f degrees; %.4f to %.4f\n",
              1e3 * by_depth.shift, by_depth.turn * DEGREES, 1e3 * by_both.shift, by_both.turn * DEGREES,
              refined.disagreement_before, refined.disagreement_after);
  EXPECT_GT(by_depth.shift, 5e-3);
  EXPECT_LE(by_both.shift, 1.5e-3);
  EXPECT_LE(by_both.turn, 0.1 / DEGREES);
}

TEST(PoseRefinement, AFrameThatSeesNothingOfTheOthersIsNamedAndStays) {
  std::vector<Camera> cameras = cameras_before_a_wall();
  cameras.push_back(camera_at({3, 0, -1}, {3, 0, 0}));
  const TestFolder folder;
  const Capture capture = wall_capture(folder, cameras);
  Device device;
  const PoseRefinement refined = refine_poses(device, capture, capture.frames, {}, {});
  ASSERT_EQ(refined.unrefined.size(), 1u);
  EXPECT_EQ(refined.unrefined[0].name, "frame-000005");
  EXPECT_LT((refined.poses[5].translation() - capture.frames[5].depth_camera.pose.translation()).norm(), 1e-3);
}

TEST(PoseRefinement, AFrameIsRegisteredToTheSurfaceOfOthers) {
  const TestFolder folder;
  const Capture capture = wall_capture(folder, cameras_before_a_wall());
  std::vector<CaptureFrame> frame(1, capture.frames[2]);
  frame[0].depth_camera.pose.translation() += Vec3(0.003, 0.002, 0.008);
  frame[0].color_camera.pose = frame[0].depth_camera.pose;
  std::vector<CaptureFrame> others = capture.frames;
  others.erase(others.begin() + 2);  // with it the frame would go along the wall, back to its own noise
  Device device;
  register_frames(device, capture, others, frame, {}, {});
  const Vec3 off = frame[0].depth_camera.pose.translation() - capture.frames[2].depth_camera.pose.translation();
  EXPECT_NEAR(off.z(), 0, 0.3e-3);
  EXPECT_NEAR(off.x(), 0.003, 0.8e-3);
  EXPECT_NEAR(off.y(), 0.002, 0.8e-3);
  EXPECT_LT((frame[0].color_camera.pose.matrix() - frame[0].depth_camera.pose.matrix()).norm(), 1e-12);
}

TEST(PoseRefinement, WhatTheSumsDoNotKnowGoesBackToWhereItWasGiven) {
  RegistrationSums sums;
  sums.hessian.setZero();
  sums.gradient.setZero();
  Vec6 off;
  off << 0.01, 0.02, -0.03, 0.004, -0.005, 0.006;
  EXPECT_LT((refining_step(sums, off, 0.01) + off).norm(), 1e-15);
  // a hundred thousand pixels of 2 mm that see the direction z alone, a millimetre off
  sums.hessian(5, 5) = 1e5 / 4e-6;
  sums.gradient(5) = 1e-3 * sums.hessian(5, 5);
  const Vec6 step = refining_step(sums, Vec6::Zero(), 0.01);
  EXPECT_NEAR(step(5), -1e-3 / 1.0012, 1e-12);  // the prior is 3000 pixels of 10 mm, 0.12 % of these
  EXPECT_EQ(step.head<5>().norm(), 0);
}

TEST(PoseRefinement, AMotionOfAllFramesTogetherIsRemoved) {
  std::mt19937 random(1);
  std::vector<Pose> given;
  for (int i = 0; i < 7; ++i) {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(0.4 * i, some_direction(random)).toRotationMatrix();
    pose.translation() = 2 * some_direction(random);
    given.push_back(pose);
  }
  std::vector<Pose> poses = given;
  for (Pose& pose : poses) pose = some_frame() * pose;
  hold_mean(given, poses);
  for (std::size_t i = 0; i < given.size(); ++i) EXPECT_LT((poses[i].matrix() - given[i].matrix()).norm(), 1e-12);
}

// The trilinear distance of samples, in double.
struct Samples {
  VoxelGrid grid{};
  std::vector<float> distance;  // [8 blocks x 512] as the kernel has them

  double at(const Vec3& world) const {
    const Vec3 p = (world - Eigen::Map<const Vec3f>(grid.origin).cast<double>()) / double(grid.voxel);
    double sum = 0;
    for (unsigned k = 0; k < 8; ++k) {
      double share = 1;
      std::size_t block = 0, inside = 0;
      for (unsigned axis = 3; axis-- > 0;) {
        const unsigned low = unsigned(p[axis]), v = low + (k >> axis & 1u);
        share *= k >> axis & 1u ? p[axis] - low : 1 - (p[axis] - low);
        block = 2 * block + v / BLOCK_SIDE;
        inside = BLOCK_SIDE * inside + v % BLOCK_SIDE;
      }
      sum += share * double(distance[block * BLOCK_VOXELS + inside]);
    }
    return sum;
  }
};

// Single pixels, each a picture of its own, before samples that rise toward the camera and are random otherwise: sums
// against differences of the residual in double. The residual is trilinear in the place, so differences are good to the
// square of their step; the device computes in float, to 1e-4 of the largest.
TEST(Registration, TheDerivativeIsThatOfTheTrilinearDistance) {
  Device device;
  Program program(device, "capture/registration.cl");
  Kernel kernel = program.kernel("register_depth");
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Samples samples;
  samples.grid.voxel = 0.05f;
  samples.grid.truncation = 1;
  samples.grid.noise[0] = 0.3f;
  samples.grid.max_depth = 4;
  const float corner[3] = {-0.4f, -0.35f, 0.65f};
  for (int axis = 0; axis < 3; ++axis) {
    samples.grid.origin[axis] = corner[axis];
    samples.grid.blocks[axis] = 2;
  }
  for (u32 i = 0; i < 8 * BLOCK_VOXELS; ++i) {
    const u32 z = i / BLOCK_VOXELS / 4 * BLOCK_SIDE + i % BLOCK_VOXELS / 64;
    samples.distance.push_back(float(0.4 - 0.05 * z + 0.01 * uniform(random)));
  }
  Buffer<float> distance(device, samples.distance, "distance"),
      weight(device, std::vector<float>(8 * BLOCK_VOXELS, 1.0f), "weight");
  Buffer<u32> block_of(device, std::vector<u32>{0, 1, 2, 3, 4, 5, 6, 7}, "block_of");
  Camera camera = camera_at({0.02, 0.01, 0.0}, {0.1, 0.05, 1});
  camera.width = 40;  // more than a work-item has
  camera.height = 3;
  camera.cx = 20;
  camera.cy = 1;
  int n_used = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const int x = trial, y = trial % 3;
    const double z = 1 + 0.1 * uniform(random);
    std::vector<std::array<float, 4>> picture(std::size_t(camera.width * camera.height), {0, 0, 0, 0});
    picture[std::size_t(y * camera.width + x)] = {0, 0, -1, float(z)};
    Buffer<std::array<float, 4>> surface(device, picture, "surface");
    Buffer<float> sums(device, REGISTRATION_SUMS, "sums");
    kernel(6, u32(6), samples.grid, pinhole_camera(camera, camera.pose.matrix()), u32(1), 0.5f, surface, block_of,
           distance, weight, sums);
    const std::vector<float> sum = sums.read();
    const Vec3 eye = camera.pose.translation();
    const Vec3 arm = camera.pose.linear() * Vec3((x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z);
    ASSERT_EQ(sum[29], 1.0f);
    const Vec3 place = (eye + arm - Eigen::Map<const Vec3f>(samples.grid.origin).cast<double>()) / 0.05;
    if ((place.array() - place.array().round()).abs().minCoeff() < 0.01) continue;  // a kink between cells is near
    const double r = samples.at(eye + arm), sigma = 0.3, w = 1 / (sigma * sigma);   // nothing is beyond two sigma
    ASSERT_LT(std::abs(r), 2 * sigma);
    ASSERT_NEAR(double(sum[28]), w, 1e-5 * w);
    ASSERT_NEAR(double(sum[27]), w * r * r, 1e-4 * w);
    constexpr double STEP = 1e-5;
    Vec6 J;
    for (int k = 0; k < 6; ++k) {
      const auto moved = [&](double step) {
        const Vec3 axis = step * Vec3::Unit(k % 3);
        return samples.at(eye + arm + (k < 3 ? axis.cross(arm).eval() : axis));
      };
      J(k) = (moved(STEP) - moved(-STEP)) / (2 * STEP);
    }
    int at = 0;
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column)
        ASSERT_NEAR(double(sum[std::size_t(at++)]), w * J(row) * J(column), 1e-3 * w) << row << ' ' << column;
    for (int row = 0; row < 6; ++row) ASSERT_NEAR(double(sum[std::size_t(at++)]), w * J(row) * r, 1e-3 * w) << row;
    n_used += std::abs(r) > 0.01;
  }
  EXPECT_GT(n_used, 20);
}

}  // namespace
}  // namespace pvg
