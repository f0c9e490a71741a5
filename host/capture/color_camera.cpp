// Where the colour camera is beside the depth camera, from the photos alone.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/capture/colors.hpp"
#include "host/pictures/gray_photo.hpp"

namespace pvg {
namespace {

constexpr std::size_t MOST_POINTS = 40000, FEWEST_POINTS = 500;
constexpr int UNKNOWNS = 9;     // rotation vector, translation, logarithm of the focal scale, principal point
constexpr double HUBER = 0.08;  // of brightness: beyond, a residual counts linearly
constexpr double PRIOR_TRANSLATION = 0.05, PRIOR_ROTATION = 0.05, PRIOR_FOCAL = 0.15,
                 PRIOR_CENTER = 10;  // how far it may be [m, rad, 1, pixels]
// how far a single photo may be from where the poses put it: tracking, and shutters that open at different times [m,
// rad]; the prior counts as much as a hundred residuals of 0.04
constexpr double MOTION_TRANSLATION = 0.0125, MOTION_ROTATION = 0.0075, MOTION_PRIOR = 100 * 0.04 * 0.04;

struct Sight {  // of a point by a frame
  std::uint32_t point, frame;
  Vec3 in_depth_camera;
};

// projection without distortion: the colour camera's offset is sought for sensors that give none
struct Projected {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, UNKNOWNS> slope;
};

struct Unknowns {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  // depth camera to colour camera
  Vec3 t = Vec3::Zero();
  double log_scale = 0;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
};

bool project(const Vec3& in_depth, const Unknowns& u, const Camera& camera, Projected& out) {
  const Vec3 q = u.R * in_depth, p = q + u.t;  // in the colour camera's frame
  if (!(p.z() > 0.05)) return false;
  const double scale = std::exp(u.log_scale), fx = camera.fx * scale, fy = camera.fy * scale, x = p.x() / p.z(),
               y = p.y() / p.z();
  out.pixel = Eigen::Vector2d(fx * x + camera.cx, fy * y + camera.cy) + u.center;
  Eigen::Matrix<double, 2, 3> d;
  d << fx / p.z(), 0, -fx * x / p.z(), 0, fy / p.z(), -fy * y / p.z();
  Eigen::Matrix3d turned;  // derivative of a small rotation of q
  turned << 0, q.z(), -q.y(), -q.z(), 0, q.x(), q.y(), -q.x(), 0;
  out.slope.leftCols<3>() = d * turned;
  out.slope.block<2, 3>(0, 3) = d;
  out.slope.col(6) = Eigen::Vector2d(fx * x, fy * y);
  out.slope.rightCols<2>().setIdentity();
  return true;
}

std::vector<Sight> find_sights(const Capture& capture, std::span<const CaptureFrame> frames,
                               const std::vector<Vec3f>& points, const std::vector<Vec3f>& normals,
                               const std::vector<std::uint32_t>& chosen, double voxel) {
  std::vector<Sight> sights;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].color.empty()) continue;
    const DepthPicture depths = depth_of(capture, frames[f]);
    const Camera& camera = frames[f].depth_camera;
    const Pose to_camera = camera.pose.inverse();
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const Vec3 p = to_camera * points[chosen[k]].cast<double>();
      if (!(p.z() > 0.1)) continue;
      const int x = int(std::lround(camera.fx * p.x() / p.z() + camera.cx)),
                y = int(std::lround(camera.fy * p.y() / p.z() + camera.cy));
      if (x < 0 || y < 0 || x >= depths.width || y >= depths.height) continue;
      const double z = depths.depth[std::size_t(y) * std::size_t(depths.width) + std::size_t(x)];
      if (!(z > 0 && std::abs(z - p.z()) < 3 * voxel * (1 + p.z() * p.z()))) continue;
      const Vec3 n = to_camera.linear() * normals[chosen[k]].cast<double>();
      if (-n.dot(p.normalized()) < 0.3) continue;
      sights.push_back({std::uint32_t(k), std::uint32_t(f), p});
    }
  }
  return sights;
}

// What the photos show of the points, and its slopes by a photo's unknowns.
struct Seen {
  std::vector<double> value;                               // of each sight, with the photo's gain; -1: none
  std::vector<Eigen::Matrix<double, 1, UNKNOWNS>> slope;   // of each sight
  std::vector<double> sum, count;                          // of each point
  std::vector<Eigen::Matrix<double, 1, UNKNOWNS>> slopes;  // of each point, the sum
};

// unknowns, gains: of each frame
Seen look(const std::vector<Sight>& sights, std::span<const CaptureFrame> frames, const std::vector<GrayPhoto>& photos,
          const std::vector<double>& gains, std::size_t n_points, const std::vector<Unknowns>& unknowns) {
  Seen out;
  out.value.assign(sights.size(), -1);
  out.slope.resize(sights.size());
  out.sum.assign(n_points, 0);
  out.count.assign(n_points, 0);
  out.slopes.assign(n_points, Eigen::Matrix<double, 1, UNKNOWNS>::Zero());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    Projected at;
    Eigen::Vector2d gradient;
    double v = 0;
    const Sight& s = sights[i];
    if (!project(s.in_depth_camera, unknowns[s.frame], frames[s.frame].color_camera, at) ||
        !photos[s.frame].at(at.pixel.x(), at.pixel.y(), v, gradient))
      continue;
    out.value[i] = gains[s.frame] * v;
    out.slope[i] = gains[s.frame] * gradient.transpose() * at.slope;
    out.sum[s.point] += out.value[i];
    out.slopes[s.point] += out.slope[i];
    out.count[s.point] += 1;
  }
  return out;
}

// Gains that bring each photo to the means; their logarithms' mean is 0.
void update_gains(const std::vector<double>& up, const std::vector<double>& down, std::vector<double>& gains) {
  double log_mean = 0, n_gains = 0;
  for (std::size_t f = 0; f < gains.size(); ++f)
    if (down[f] > 0) {
      gains[f] *= up[f] / down[f];
      log_mean += std::log(gains[f]);
      n_gains += 1;
    }
  for (double& gain : gains) gain /= std::exp(log_mean / std::max(1.0, n_gains));
}

// One Gauss-Newton step against the mean brightness of each point; returns the root mean square disagreement before it.
double step(const std::vector<Sight>& sights, std::span<const CaptureFrame> frames,
            const std::vector<GrayPhoto>& photos, std::vector<double>& gains, std::size_t n_points, Unknowns& u,
            bool moves) {
  const Seen seen = look(sights, frames, photos, gains, n_points, std::vector<Unknowns>(frames.size(), u));
  Eigen::Matrix<double, UNKNOWNS, UNKNOWNS> H = Eigen::Matrix<double, UNKNOWNS, UNKNOWNS>::Zero();
  Eigen::Matrix<double, UNKNOWNS, 1> g = Eigen::Matrix<double, UNKNOWNS, 1>::Zero();
  double squares = 0, n = 0;
  std::vector<double> gain_up(frames.size(), 0), gain_down(frames.size(), 0);
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Sight& s = sights[i];
    if (seen.value[i] < 0 || seen.count[s.point] < 3) continue;
    const double mean = seen.sum[s.point] / seen.count[s.point], r = seen.value[i] - mean;
    const auto J = (seen.slope[i] - seen.slopes[s.point] / seen.count[s.point]).eval();
    const double weight = std::abs(r) < HUBER ? 1 : HUBER / std::abs(r);
    H += weight * J.transpose() * J;
    g += weight * J.transpose() * r;
    squares += r * r;
    n += 1;
    gain_up[s.frame] += weight * mean * seen.value[i];
    gain_down[s.frame] += weight * seen.value[i] * seen.value[i];
  }
  if (!moves || n == 0) return n > 0 ? std::sqrt(squares / n) : 0;
  // the prior counts as much as a hundred residuals
  const double prior = 100 * HUBER * HUBER;
  const Eigen::AngleAxisd turned(u.R);
  for (int k = 0; k < 3; ++k) {
    H(k, k) += prior / std::pow(PRIOR_ROTATION, 2);
    g(k) += prior / std::pow(PRIOR_ROTATION, 2) * turned.angle() * turned.axis()[k];
    H(3 + k, 3 + k) += prior / std::pow(PRIOR_TRANSLATION, 2);
    g(3 + k) += prior / std::pow(PRIOR_TRANSLATION, 2) * u.t[k];
  }
  H(6, 6) += prior / std::pow(PRIOR_FOCAL, 2);
  g(6) += prior / std::pow(PRIOR_FOCAL, 2) * u.log_scale;
  for (int k = 0; k < 2; ++k) {
    H(7 + k, 7 + k) += prior / std::pow(PRIOR_CENTER, 2);
    g(7 + k) += prior / std::pow(PRIOR_CENTER, 2) * u.center[k];
  }
  const Eigen::Matrix<double, UNKNOWNS, 1> d = -H.ldlt().solve(g);
  const Vec3 w = d.head<3>();
  if (w.norm() > 0) u.R = Eigen::AngleAxisd(w.norm(), w.normalized()) * u.R;
  u.t += d.segment<3>(3);
  u.log_scale += d(6);
  u.center += d.tail<2>();
  update_gains(gain_up, gain_down, gains);
  return std::sqrt(squares / n);
}

// Moves each photo a little against the means, which stand still meanwhile; `u`: where all would be without. Returns
// the root mean square disagreement before it.
double move_photos(const std::vector<Sight>& sights, std::span<const CaptureFrame> frames,
                   const std::vector<GrayPhoto>& photos, std::vector<double>& gains, std::size_t n_points,
                   const Unknowns& u, std::vector<Unknowns>& moved) {
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  const Seen seen = look(sights, frames, photos, gains, n_points, moved);
  std::vector<Eigen::Matrix<double, 6, 6>> H(frames.size(), Eigen::Matrix<double, 6, 6>::Zero());
  std::vector<Vec6> g(frames.size(), Vec6::Zero());
  std::vector<double> gain_up(frames.size(), 0), gain_down(frames.size(), 0);
  double squares = 0, n = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Sight& s = sights[i];
    if (seen.value[i] < 0 || seen.count[s.point] < 3) continue;
    const double mean = seen.sum[s.point] / seen.count[s.point], r = seen.value[i] - mean;
    const double weight = std::abs(r) < HUBER ? 1 : HUBER / std::abs(r);
    const Vec6 J = seen.slope[i].head<6>().transpose();
    H[s.frame] += weight * J * J.transpose();
    g[s.frame] += weight * r * J;
    squares += r * r;
    n += 1;
    gain_up[s.frame] += weight * mean * seen.value[i];
    gain_down[s.frame] += weight * seen.value[i] * seen.value[i];
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const Eigen::AngleAxisd turned(moved[f].R * u.R.transpose());
    Vec6 off;
    off << turned.angle() * turned.axis(), moved[f].t - u.t;
    Vec6 prior;
    prior << Vec3::Constant(MOTION_PRIOR / std::pow(MOTION_ROTATION, 2)),
        Vec3::Constant(MOTION_PRIOR / std::pow(MOTION_TRANSLATION, 2));
    H[f].diagonal() += prior;
    g[f] += prior.cwiseProduct(off);
    const Vec6 d = -H[f].ldlt().solve(g[f]);
    const Vec3 w = d.head<3>();
    if (w.norm() > 0) moved[f].R = Eigen::AngleAxisd(w.norm(), w.normalized()) * moved[f].R;
    moved[f].t += d.tail<3>();
  }
  update_gains(gain_up, gain_down, gains);
  return n > 0 ? std::sqrt(squares / n) : 0;
}

Pose color_to_depth(const Unknowns& u) {
  Pose to_color = Pose::Identity();
  to_color.linear() = u.R;
  to_color.translation() = u.t;
  return to_color.inverse();
}

}  // namespace

ColorOffset align_color_camera(const Capture& capture, std::span<const CaptureFrame> frames,
                               const std::vector<Vec3f>& points, const std::vector<Vec3f>& normals, double voxel) {
  std::mt19937 random(0);
  std::vector<std::uint32_t> chosen;
  for (std::size_t k = 0; k < std::min(MOST_POINTS, points.size()); ++k)
    chosen.push_back(std::uint32_t(random() % points.size()));
  const std::vector<Sight> sights = find_sights(capture, frames, points, normals, chosen, voxel);
  std::vector<int> count(chosen.size(), 0);
  for (const Sight& s : sights) ++count[s.point];
  ColorOffset out;
  out.n_points = std::size_t(std::count_if(count.begin(), count.end(), [](int n) { return n >= 3; }));
  if (out.n_points < FEWEST_POINTS)
    throw UsageError("the colour camera cannot be aligned: three photos see only " + counted(out.n_points, "point") +
                     " of the surface; take more photos, or give --align-colors no");
  std::vector<GrayPhoto> sharp(frames.size());
  for (std::size_t f = 0; f < frames.size(); ++f)
    if (!frames[f].color.empty()) sharp[f] = gray_of(color_of(frames[f]));
  Unknowns u;
  std::vector<double> gains(frames.size(), 1.0);
  bool is_first = true;
  for (const int rounds : {64, 16, 4, 1}) {  // blurred by 5.7, 2.8, 1.4 and 0.7 pixels
    std::vector<GrayPhoto> photos = sharp;
    for (GrayPhoto& photo : photos)
      if (photo.width > 0) blur(photo, rounds);
    if (is_first) {
      std::vector<GrayPhoto> last = sharp;
      for (GrayPhoto& photo : last)
        if (photo.width > 0) blur(photo, 1);
      out.disagreement_before = step(sights, frames, last, gains, chosen.size(), u, false);
      is_first = false;
    }
    for (int i = 0; i < 12; ++i) step(sights, frames, photos, gains, chosen.size(), u, true);
    out.disagreement_after = step(sights, frames, photos, gains, chosen.size(), u, false);
  }
  std::vector<Unknowns> moved(frames.size(), u);
  for (const int rounds : {32, 8, 2}) {  // blurred by 4, 2 and 1 pixels
    std::vector<GrayPhoto> photos = sharp;
    for (GrayPhoto& photo : photos)
      if (photo.width > 0) blur(photo, rounds);
    for (int i = 0; i < 12; ++i)
      out.disagreement_moved = move_photos(sights, frames, photos, gains, chosen.size(), u, moved);
  }
  out.pose = color_to_depth(u);
  for (const Unknowns& m : moved) out.photo_poses.push_back(color_to_depth(m));
  out.focal_scale = std::exp(u.log_scale);
  out.center[0] = u.center.x();
  out.center[1] = u.center.y();
  return out;
}

}  // namespace pvg
