#include "host/capture/pose_refinement.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <ctime>

#include "host/base/error.hpp"
#include "host/capture/photo_agreement.hpp"

namespace pvg {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

constexpr double PIXELS_PER_MEASUREMENT = 3000;  // errors of depth are alike over patches of about 55 pixels a side
constexpr double COARSE_TRUNCATION = 3;          // voxels: more blurs what is thin
constexpr double LEAST_SHARE = 0.02;             // of a picture's pixels, near what others show
constexpr int MOST_STEPS = 4;                    // of a picture in a sweep
constexpr int MOST_STEPS_ALONE = 12;             // of a picture that is registered to what is fused already
constexpr double SMALLEST_STEP = 1e-4;           // [m, rad]: smaller ones end a picture's steps, and all sweeps
constexpr double LEAST_GAIN = 0.99;              // of the distance by a sweep; less ends them
constexpr int PHOTO_BLUR[] = {8, 2};             // rounds: by 2 pixels, then by one

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

  FusedSurface surface() { return fusion_.surface(); }

  // returns the largest motion of a frame; photos count as well where they are given
  double sweep(PhotoAgreement* photos = nullptr) {
    unrefined.clear();
    double largest = 0, squares = 0, weight = 0;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      Camera& camera = frames_[i].depth_camera;
      const Pose before = camera.pose;
      const DepthPicture picture = depth_of(capture_, frames_[i]);
      fusion_.take_out(camera, picture);
      const RegistrationSums first = move(camera, picture, given_[i], MOST_STEPS, photos, i);
      frames_[i].color_camera.pose = camera.pose * before.inverse() * frames_[i].color_camera.pose;
      if (photos) photos->update(i, camera.pose);
      squares += first.squares;
      weight += first.weight;
      const double share = first.n_pixels / double(picture.depth.size());
      if (share < LEAST_SHARE) unrefined.push_back({frames_[i].name, share});
      largest = std::max(largest, size_of(motion(before, camera.pose)));
      fusion_.integrate(camera, picture);
    }
    distance = weight > 0 ? std::sqrt(squares / weight) : 0;
    return largest;
  }

  // Steps of a picture that is not fused, which is that of the photo `frame` where there are photos; returns the sums
  // of depth before the first one. With too few pixels it is where it was given.
  RegistrationSums move(Camera& camera, const DepthPicture& picture, const Pose& given, int most_steps,
                        const PhotoAgreement* photos = nullptr, std::size_t frame = 0) {
    const RegistrationSums first = fusion_.registration(camera, picture);
    RegistrationSums sums = first;
    for (int k = 0; k < most_steps; ++k) {
      if (sums.n_pixels < LEAST_SHARE * double(picture.depth.size())) {
        camera.pose = given;
        break;
      }
      if (photos) {
        const RegistrationSums seen = photos->registration(frame, camera.pose, sums.n_pixels);
        sums.hessian += seen.hessian;
        sums.gradient += seen.gradient;
      }
      const Vec6 step = refining_step(sums, motion(given, camera.pose), settings_.sigma);
      camera.pose.linear() = rotation_of(step.head<3>()) * camera.pose.linear();
      camera.pose.translation() += step.tail<3>();
      if (size_of(step) < SMALLEST_STEP || k + 1 == most_steps) break;
      sums = fusion_.registration(camera, picture);
    }
    return first;
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

// How far the frames moved from where they were given.
void tell_motion(std::span<const Pose> given, PoseRefinement& out) {
  const double n = double(given.size());
  out.mean_turn = out.mean_shift = out.largest_turn = out.largest_shift = 0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Vec6 m = motion(given[i], out.poses[i]);
    out.mean_turn += m.head<3>().norm() / n;
    out.mean_shift += m.tail<3>().norm() / n;
    out.largest_turn = std::max(out.largest_turn, m.head<3>().norm());
    out.largest_shift = std::max(out.largest_shift, m.tail<3>().norm());
  }
}

// The frames go where the sweeps brought them, but for their mean motion.
void take_poses(std::span<const Pose> given, std::vector<CaptureFrame>& frames, PoseRefinement& out) {
  std::vector<Pose> poses;
  for (const CaptureFrame& frame : frames) poses.push_back(frame.depth_camera.pose);
  hold_mean(given, poses);
  apply_poses(poses, frames);
  out.poses = std::move(poses);
}

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
  for (const FusionSettings& grid : {coarse(fusion, settings.sigma), fusion}) {
    Sweeps sweeps(device, capture, moved, given, grid, settings);
    double last = INFINITY;
    for (int k = 0; k < settings.most_sweeps; ++k) {
      const double largest = sweeps.sweep();
      ++out.n_sweeps;
      if (out.n_sweeps == 1) out.distance_before = sweeps.distance;
      out.distance_after = sweeps.distance;
      if (largest < SMALLEST_STEP || sweeps.distance > LEAST_GAIN * last) break;
      last = sweeps.distance;
    }
    out.unrefined = sweeps.unrefined;
    take_poses(given, moved, out);
  }
  tell_motion(given, out);
  out.cpu_ms_per_frame = 1e3 * double(std::clock() - start) / CLOCKS_PER_SEC / double(frames.size());
  return out;
}

void refine_with_photos(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                        std::span<const Pose> given, const FusionSettings& fusion,
                        const PoseRefinementSettings& settings, PoseRefinement& refined) {
  const std::clock_t start = std::clock();
  std::vector<CaptureFrame> moved(frames.begin(), frames.end());
  for (const int blur_rounds : PHOTO_BLUR) {
    PhotoAgreement photos(device, moved, blur_rounds);
    Sweeps sweeps(device, capture, moved, given, fusion, settings);
    double last = INFINITY;
    for (int k = 0; k < settings.most_sweeps; ++k) {
      photos.look(capture, moved, sweeps.surface(), fusion.voxel);
      const double disagreement = photos.disagreement();
      if (disagreement > LEAST_GAIN * last) break;
      last = disagreement;
      if (k == 0) refined.disagreement_before = disagreement;
      const double largest = sweeps.sweep(&photos);
      ++refined.n_sweeps;
      refined.distance_after = sweeps.distance;
      if (largest < SMALLEST_STEP) break;
    }
    refined.disagreement_after = photos.disagreement();
    take_poses(given, moved, refined);
  }
  tell_motion(given, refined);
  refined.cpu_ms_per_frame += 1e3 * double(std::clock() - start) / CLOCKS_PER_SEC / double(frames.size());
}

void register_frames(Device& device, const Capture& capture, std::span<const CaptureFrame> fused,
                     std::span<CaptureFrame> frames, const FusionSettings& fusion,
                     const PoseRefinementSettings& settings) {
  if (frames.empty()) return;
  std::vector<CaptureFrame> model(fused.begin(), fused.end());
  std::vector<Pose> given;
  for (const CaptureFrame& frame : frames) given.push_back(frame.depth_camera.pose);
  std::vector<Pose> poses = given;
  for (const FusionSettings& grid : {coarse(fusion, settings.sigma), fusion}) {
    Sweeps sweeps(device, capture, model, {}, grid, settings);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      Camera camera = frames[i].depth_camera;
      camera.pose = poses[i];
      sweeps.move(camera, depth_of(capture, frames[i]), given[i], MOST_STEPS_ALONE);
      poses[i] = camera.pose;
    }
  }
  apply_poses(poses, frames);
}

}  // namespace pvg
