#include "host/capture/pose_refinement.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "host/base/error.hpp"

namespace pvg {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

constexpr double PIXELS_PER_MEASUREMENT = 100;  // errors of depth are alike over patches of about ten pixels a side
constexpr double COARSE_TRUNCATION = 6;         // standard deviations of the poses
constexpr double LEAST_SHARE = 0.02;            // of a picture's pixels, near what others show
constexpr int MOST_STEPS = 4;                   // of a picture in a sweep
constexpr double SMALLEST_STEP = 1e-4;          // [m, rad]: smaller ones end a sweep's steps, and all sweeps

Vec3 rotation_vector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turned(R);
  return turned.angle() * turned.axis();
}

Eigen::Matrix3d rotation_of(const Vec3& w) {
  return w.norm() > 0 ? Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

// rotation and translation from one pose to the other, both along the axes of the world
Vec6 motion(const Pose& from, const Pose& to) {
  Vec6 m;
  m << rotation_vector(to.linear() * from.linear().transpose()), to.translation() - from.translation();
  return m;
}

double size_of(const Vec6& step) { return std::max(step.head<3>().norm(), step.tail<3>().norm()); }

FusionSettings coarse(FusionSettings settings, double sigma) {
  settings.voxel = std::max(settings.voxel, sigma);
  settings.truncation = COARSE_TRUNCATION * settings.voxel;
  return settings;
}

// All frames in one grid of distances; sweeps over them until none moves.
class Sweeps {
 public:
  Sweeps(Device& device, const Capture& capture, std::vector<CaptureFrame>& frames, std::span<const Pose> given,
         const FusionSettings& fusion, const PoseRefinementSettings& settings)
      : capture_(capture), frames_(frames), given_(given), settings_(settings), fusion_(device, fusion, box(fusion)) {
    for (const CaptureFrame& frame : frames_) fusion_.mark(frame.depth_camera, depth_of(capture_, frame));
    fusion_.allocate();
    for (const CaptureFrame& frame : frames_) fusion_.integrate(frame.depth_camera, depth_of(capture_, frame));
  }

  // returns the largest motion of a frame
  double sweep() {
    unrefined.clear();
    double largest = 0, squares = 0, weight = 0;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      Camera& camera = frames_[i].depth_camera;
      const Pose before = camera.pose;
      const DepthPicture picture = depth_of(capture_, frames_[i]);
      fusion_.take_out(camera, picture);
      const double n_pixels = double(picture.depth.size());
      for (int k = 0; k < MOST_STEPS; ++k) {
        const RegistrationSums sums = fusion_.registration(camera);
        if (sums.n_pixels < LEAST_SHARE * n_pixels) {
          unrefined.push_back({frames_[i].name, sums.n_pixels / n_pixels});
          camera.pose = given_[i];
          break;
        }
        if (k == 0) {
          squares += sums.squares;
          weight += sums.weight;
        }
        const Vec6 step = refining_step(sums, motion(given_[i], camera.pose), settings_.sigma);
        camera.pose.linear() = rotation_of(step.head<3>()) * camera.pose.linear();
        camera.pose.translation() += step.tail<3>();
        if (size_of(step) < SMALLEST_STEP) break;
      }
      largest = std::max(largest, size_of(motion(before, camera.pose)));
      fusion_.integrate(camera, picture);
    }
    distance = weight > 0 ? std::sqrt(squares / weight) : 0;
    return largest;
  }

  std::vector<UnrefinedFrame> unrefined;
  double distance = 0;  // root mean square, before the frames' steps [m]

 private:
  Box box(const FusionSettings& fusion) const {
    Box seen;
    for (const CaptureFrame& frame : frames_) {
      const DepthPicture picture = depth_of(capture_, frame);
      check_depth_scale(capture_, frame, picture);
      seen.add(seen_box(frame.depth_camera, picture, fusion.max_depth));
    }
    if (!(seen.lo.x() <= seen.hi.x())) throw UsageError("no frame shows a depth below --max-depth");
    return seen;
  }

  const Capture& capture_;
  std::vector<CaptureFrame>& frames_;
  std::span<const Pose> given_;
  const PoseRefinementSettings& settings_;
  Fusion fusion_;
};

}  // namespace

Vec6 refining_step(const RegistrationSums& sums, const Vec6& off, double sigma) {
  const double prior = PIXELS_PER_MEASUREMENT / (sigma * sigma);
  const Eigen::Matrix<double, 6, 6> H = sums.hessian + prior * Eigen::Matrix<double, 6, 6>::Identity();
  return -H.ldlt().solve(sums.gradient + prior * off);
}

void hold_mean(std::span<const Pose> given, std::span<Pose> poses) {
  const double n = double(poses.size());
  Vec3 turn = Vec3::Zero(), from = Vec3::Zero(), to = Vec3::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    turn += rotation_vector(given[i].linear() * poses[i].linear().transpose()) / n;
    from += poses[i].translation() / n;
    to += given[i].translation() / n;
  }
  const Eigen::Matrix3d R = rotation_of(turn);
  for (Pose& pose : poses) {
    pose.linear() = R * pose.linear();
    pose.translation() = R * (pose.translation() - from) + to;
  }
}

void apply_poses(std::span<const Pose> poses, std::span<CaptureFrame> frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].color_camera.pose = poses[i] * frames[i].depth_camera.pose.inverse() * frames[i].color_camera.pose;
    frames[i].depth_camera.pose = poses[i];
  }
}

PoseRefinement refine_poses(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                            const FusionSettings& fusion, const PoseRefinementSettings& settings) {
  const std::clock_t start = std::clock();
  std::vector<CaptureFrame> moved(frames.begin(), frames.end());
  std::vector<Pose> given;
  for (const CaptureFrame& frame : frames) given.push_back(frame.depth_camera.pose);
  PoseRefinement out;
  out.poses = given;
  const char* stages = std::getenv("PVG_STAGES");
  for (const char* s = stages ? stages : "cf"; *s; ++s) {
    Sweeps sweeps(device, capture, moved, given, *s == 'c' ? coarse(fusion, settings.sigma) : fusion, settings);
    for (int k = 0; k < settings.most_sweeps; ++k) {
      const double largest = sweeps.sweep();
      ++out.n_sweeps;
      if (std::getenv("PVG_LOG")) std::fprintf(stderr, "%c sweep %d: largest %.3f mm, distance %.3f mm\n", *s, k, 1e3 * largest, 1e3 * sweeps.distance);
      if (out.n_sweeps == 1) out.distance_before = sweeps.distance;
      out.distance_after = sweeps.distance;
      if (largest < SMALLEST_STEP) break;
    }
    out.unrefined = sweeps.unrefined;
    for (std::size_t i = 0; i < moved.size(); ++i) out.poses[i] = moved[i].depth_camera.pose;
    hold_mean(given, out.poses);
    apply_poses(out.poses, moved);
  }
  const double n = double(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vec6 m = motion(given[i], out.poses[i]);
    out.mean_turn += m.head<3>().norm() / n;
    out.mean_shift += m.tail<3>().norm() / n;
    out.largest_turn = std::max(out.largest_turn, m.head<3>().norm());
    out.largest_shift = std::max(out.largest_shift, m.tail<3>().norm());
  }
  out.cpu_ms_per_frame = 1e3 * double(std::clock() - start) / CLOCKS_PER_SEC / n;
  return out;
}

}  // namespace pvg
