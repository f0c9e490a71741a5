// A point X of the surface is seen by photo I of gain g with the residual
//
//   r = g I(pi(X)) - m(X),   m: mean of the other photos that see it.
//
// The depth camera at c turns by w about itself and moves by v, the colour camera with it; for both X moves by
// (X - c) x w - v. A point stands for as many pixels as the depth picture has for each point, and each counts with
// 1 / sigma^2 as in registration.cl; Geman's and McClure's loss takes out what the photos show of different things.
#include "host/capture/photo_agreement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "host/base/statistics.hpp"
#include "host/capture/surface.hpp"
#include "host/render/camera.hpp"

namespace pvg {
namespace {

constexpr std::size_t MOST_AGREED_POINTS = 20000;
constexpr double FEWEST_OTHERS = 2;       // photos that see a point
constexpr double LEAST_FACING = 0.3;      // cosine between a point's normal and the way to the camera
constexpr double LOSS_WIDTH = 2;          // standard deviations
constexpr double MEDIAN_TO_SIGMA = 1.48;  // of absolute values of a normal distribution
constexpr double LEAST_SIGMA = 0.01;      // steps of 8 bits, and what cameras do to them
constexpr int EDGE_REACH = 4;  // photos are blurred: what is so near an edge of depth does not count [pixels]
constexpr int EXPOSURE_ROUNDS = 5;

// [n] from the middle of the first pixel; -1: behind the camera
std::vector<Eigen::Vector2f> pixels_of(Device& device, const PinholeCamera& camera, const std::vector<Vec3>& points) {
  Program program(device, "capture/rays.cl");
  Kernel point_pixels = program.kernel("point_pixels");
  std::vector<float> packed;
  for (const Vec3& p : points) packed.insert(packed.end(), {float(p.x()), float(p.y()), float(p.z())});
  Buffer<float> place(device, packed, "points"), pixels(device, 2 * points.size(), "pixels");
  point_pixels(points.size(), u32(points.size()), camera, place, pixels);
  const std::vector<float> found = pixels.read();
  std::vector<Eigen::Vector2f> out;
  for (std::size_t i = 0; i < points.size(); ++i) out.emplace_back(found[2 * i], found[2 * i + 1]);
  return out;
}

// the photo that a camera without distortion takes there; the camera becomes that one
GrayPhoto straightened(Device& device, const GrayPhoto& photo, Camera& camera) {
  if (camera.distortion.empty() && camera.model == Camera::Model::pinhole) return photo;
  std::vector<Vec3> directions;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      directions.emplace_back((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
  GrayPhoto out{photo.width, photo.height, {}};
  Eigen::Vector2d slope;
  for (const Eigen::Vector2f& at : pixels_of(device, pinhole_camera(camera, Eigen::Matrix4d::Identity()), directions)) {
    double value = 0;
    out.value.push_back(photo.at(double(at.x()), double(at.y()), value, slope) ? float(value) : NAN);
  }
  camera.distortion.clear();
  camera.model = Camera::Model::pinhole;
  return out;
}

// depth at a pixel is `z` and goes on evenly to both sides
bool is_smooth(const DepthPicture& picture, int x, int y, double z, double tolerance) {
  const auto depth = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= picture.width || j >= picture.height) return 0.0;
    return double(picture.depth[std::size_t(j) * std::size_t(picture.width) + std::size_t(i)]);
  };
  const double middle = depth(x, y);
  if (!(middle > 0 && std::abs(middle - z) < tolerance)) return false;
  for (const auto& [i, j] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
    const double before = depth(x - EDGE_REACH * i, y - EDGE_REACH * j),
                 after = depth(x + EDGE_REACH * i, y + EDGE_REACH * j);
    if (!(before > 0 && after > 0 && std::abs(0.5 * (before + after) - middle) < tolerance)) return false;
  }
  return true;
}

}  // namespace

PhotoAgreement::PhotoAgreement(Device& device, std::span<const CaptureFrame> frames, int blur_rounds)
    : device_(device) {
  for (const CaptureFrame& frame : frames) {
    View view{frame.color_camera, frame.depth_camera.pose.inverse() * frame.color_camera.pose, {}, 1, {}};
    if (!frame.color.empty()) {
      GrayPhoto photo = gray_of(color_of(frame));
      blur(photo, blur_rounds);
      view.photo = straightened(device, photo, view.camera);
    }
    views_.push_back(std::move(view));
  }
}

bool PhotoAgreement::see(const View& view, const Pose& depth_pose, const Vec3& point, double& value,
                         Eigen::Matrix<double, 1, 6>* slope) const {
  const Camera& camera = view.camera;
  const Pose to_color = (depth_pose * view.in_depth_camera).inverse();
  const Vec3 p = to_color * point;
  if (!(p.z() > 0.05)) return false;
  const double x = p.x() / p.z(), y = p.y() / p.z();
  Eigen::Vector2d gradient;
  if (!view.photo.at(camera.fx * x + camera.cx, camera.fy * y + camera.cy, value, gradient)) return false;
  value *= view.gain;
  if (!std::isfinite(value)) return false;
  if (!slope) return true;
  Eigen::Matrix<double, 2, 3> projection;
  projection << camera.fx / p.z(), 0, -camera.fx * x / p.z(), 0, camera.fy / p.z(), -camera.fy * y / p.z();
  const Vec3 along = view.gain * (gradient.transpose() * projection * to_color.linear()).transpose();
  *slope << along.cross(point - depth_pose.translation()).transpose(), -along.transpose();
  return true;
}

double PhotoAgreement::mean_of_others(const Sight& sight) const {
  const double others = count_[sight.point] - 1;
  return sight.value < 0 || others < FEWEST_OTHERS ? -1 : (sum_[sight.point] - sight.value) / others;
}

void PhotoAgreement::look(const Capture& capture, std::span<const CaptureFrame> frames, const FusedSurface& surface,
                          double voxel) {
  const std::vector<Vec3f> normals = point_normals(surface.points, surface.triangles);
  std::mt19937 random(0);
  std::vector<Vec3> facing;
  points_.clear();
  for (std::size_t k = 0; k < std::min(MOST_AGREED_POINTS, surface.points.size()); ++k) {
    const std::size_t i = random() % surface.points.size();
    points_.push_back(surface.points[i].cast<double>());
    facing.push_back(normals[i].cast<double>());
  }
  sum_.assign(points_.size(), 0);
  count_.assign(points_.size(), 0);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    views_[f].sights.clear();
    if (views_[f].photo.width == 0) continue;
    const DepthPicture depths = depth_of(capture, frames[f]);
    const Pose& pose = frames[f].depth_camera.pose;
    const std::vector<Eigen::Vector2f> pixels =
        pixels_of(device_, pinhole_camera(frames[f].depth_camera, pose.matrix()), points_);
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const double z = (pose.inverse() * points_[k]).z();
      if (!(z > 0.1) || -facing[k].dot((points_[k] - pose.translation()).normalized()) < LEAST_FACING) continue;
      if (is_smooth(depths, int(std::lround(pixels[k].x())), int(std::lround(pixels[k].y())), z,
                    3 * voxel * (1 + z * z)))
        views_[f].sights.push_back({std::uint32_t(k), -1});
    }
    update(f, pose);
  }
  bring_to_one_exposure(frames);
  std::vector<double> off;
  for (const View& view : views_)
    for (const Sight& s : view.sights)
      if (const double mean = mean_of_others(s); mean >= 0) off.push_back(std::abs(s.value - mean));
  sigma_ = LEAST_SIGMA;
  if (off.empty()) return;
  sigma_ = std::max(LEAST_SIGMA, MEDIAN_TO_SIGMA * upper_median(std::move(off)));
}

// Gains toward the means of the others; their logarithms' mean is 0.
void PhotoAgreement::bring_to_one_exposure(std::span<const CaptureFrame> frames) {
  for (int round = 0; round < EXPOSURE_ROUNDS; ++round) {
    double log_mean = 0, n = 0;
    std::vector<double> gains;
    for (const View& view : views_) {
      double up = 0, down = 0;
      for (const Sight& s : view.sights)
        if (const double mean = mean_of_others(s); mean >= 0) {
          up += mean * s.value;
          down += s.value * s.value;
        }
      gains.push_back(up > 0 && down > 0 ? view.gain * up / down : view.gain);
      log_mean += std::log(gains.back());
      n += 1;
    }
    for (std::size_t f = 0; f < views_.size(); ++f) {
      views_[f].gain = gains[f] / std::exp(log_mean / n);
      update(f, frames[f].depth_camera.pose);
    }
  }
}

void PhotoAgreement::update(std::size_t frame, const Pose& depth_pose) {
  for (Sight& s : views_[frame].sights) {
    if (s.value >= 0) {
      sum_[s.point] -= s.value;
      count_[s.point] -= 1;
    }
    if (!see(views_[frame], depth_pose, points_[s.point], s.value, nullptr)) {
      s.value = -1;
      continue;
    }
    sum_[s.point] += s.value;
    count_[s.point] += 1;
  }
}

RegistrationSums PhotoAgreement::registration(std::size_t frame, const Pose& depth_pose, double n_pixels) const {
  const View& view = views_[frame];
  RegistrationSums out;
  out.hessian.setZero();
  out.gradient.setZero();
  if (view.sights.empty()) return out;
  const double pixels = n_pixels / double(view.sights.size()), width = LOSS_WIDTH * sigma_;
  for (const Sight& s : view.sights) {
    const double mean = mean_of_others(s);
    double value = 0;
    Eigen::Matrix<double, 1, 6> J;
    if (mean < 0 || !see(view, depth_pose, points_[s.point], value, &J)) continue;
    const double r = value - mean, share = 1 / (1 + r * r / (width * width)),
                 weight = pixels * share * share / (sigma_ * sigma_);
    out.hessian += weight * J.transpose() * J;
    out.gradient += weight * r * J.transpose();
    out.squares += weight * r * r;
    out.weight += weight;
    out.n_pixels += pixels;
  }
  return out;
}

double PhotoAgreement::disagreement() const {
  double squares = 0, n = 0;
  for (const View& view : views_)
    for (const Sight& s : view.sights)
      if (const double mean = mean_of_others(s); mean >= 0) {
        squares += (s.value - mean) * (s.value - mean);
        n += 1;
      }
  return n > 0 ? std::sqrt(squares / n) : 0;
}

}  // namespace pvg
