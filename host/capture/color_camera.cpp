// Where the colour camera is beside the depth camera, from the photos alone.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "host/base/error.hpp"
#include "host/capture/colors.hpp"

namespace pvg {
namespace {

constexpr std::size_t MOST_POINTS = 12000, FEWEST_POINTS = 500;
constexpr int UNKNOWNS = 7;     // rotation vector, translation, logarithm of the focal scale
constexpr double HUBER = 0.08;  // of brightness: beyond, a residual counts linearly
constexpr double PRIOR_TRANSLATION = 0.05, PRIOR_ROTATION = 0.05, PRIOR_FOCAL = 0.15;  // how far it may be [m, rad, 1]

struct Gray {
  int width = 0, height = 0;
  std::vector<float> value;  // sRGB luma [height x width]

  // bilinear, with its slope per pixel; false: outside
  bool at(double x, double y, double& v, Eigen::Vector2d& slope) const {
    const int i = int(std::floor(x)), j = int(std::floor(y));
    if (i < 0 || j < 0 || i + 1 >= width || j + 1 >= height) return false;
    const double f = x - i, g = y - j;
    const float* p = &value[std::size_t(j) * std::size_t(width) + std::size_t(i)];
    const double a = p[0], b = p[1], c = p[width], d = p[width + 1];
    v = (a * (1 - f) + b * f) * (1 - g) + (c * (1 - f) + d * f) * g;
    slope = {(b - a) * (1 - g) + (d - c) * g, (c - a) * (1 - f) + (d - b) * f};
    return true;
  }
};

Gray gray_of(const Picture8& picture) {
  Gray gray{picture.width, picture.height, {}};
  for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3)
    gray.value.push_back(float(0.299 * picture.rgb[i] + 0.587 * picture.rgb[i + 1] + 0.114 * picture.rgb[i + 2]) / 255);
  return gray;
}

// binomial filter, `rounds` times; each adds 1/2 to the variance [pixels^2]
void blur(Gray& gray, int rounds) {
  for (int k = 0; k < rounds; ++k)
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<float> out(gray.value.size());
      const int step = axis == 0 ? 1 : gray.width;
      for (int y = 0; y < gray.height; ++y)
        for (int x = 0; x < gray.width; ++x) {
          const int at = y * gray.width + x, along = axis == 0 ? x : y,
                    last = (axis == 0 ? gray.width : gray.height) - 1;
          const float* v = gray.value.data();
          out[std::size_t(at)] =
              0.5f * v[at] + 0.25f * v[along > 0 ? at - step : at] + 0.25f * v[along < last ? at + step : at];
        }
      gray.value.swap(out);
    }
}

struct Sight {  // of a point by a frame
  std::uint32_t point, frame;
  Vec3 in_depth_camera;
};

// projection without distortion: the colour camera's offset is sought for sensors that give none
struct Projected {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, UNKNOWNS> slope;
};

bool project(const Vec3& in_depth, const Eigen::Matrix3d& R, const Vec3& t, double scale, const Camera& camera,
             Projected& out) {
  const Vec3 q = R * in_depth, p = q + t;  // in the colour camera's frame
  if (!(p.z() > 0.05)) return false;
  const double fx = camera.fx * scale, fy = camera.fy * scale, x = p.x() / p.z(), y = p.y() / p.z();
  out.pixel = {fx * x + camera.cx, fy * y + camera.cy};
  Eigen::Matrix<double, 2, 3> d;
  d << fx / p.z(), 0, -fx * x / p.z(), 0, fy / p.z(), -fy * y / p.z();
  Eigen::Matrix3d turned;  // derivative of a small rotation of q
  turned << 0, q.z(), -q.y(), -q.z(), 0, q.x(), q.y(), -q.x(), 0;
  out.slope.leftCols<3>() = d * turned;
  out.slope.block<2, 3>(0, 3) = d;
  out.slope.col(6) = Eigen::Vector2d(fx * x, fy * y);
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

struct Unknowns {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  // depth camera to colour camera
  Vec3 t = Vec3::Zero();
  double log_scale = 0;
};

// One Gauss-Newton step against the mean brightness of each point; returns the root mean square disagreement before it.
double step(const std::vector<Sight>& sights, std::span<const CaptureFrame> frames, const std::vector<Gray>& photos,
            std::vector<double>& gains, std::size_t n_points, Unknowns& u, bool moves) {
  std::vector<double> value(sights.size(), -1), sum(n_points, 0), count(n_points, 0);
  std::vector<Eigen::Matrix<double, 1, UNKNOWNS>> slope(sights.size());
  std::vector<Eigen::Matrix<double, 1, UNKNOWNS>> mean_slope(n_points, Eigen::Matrix<double, 1, UNKNOWNS>::Zero());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    Projected seen;
    Eigen::Vector2d gradient;
    double v = 0;
    const Sight& s = sights[i];
    if (!project(s.in_depth_camera, u.R, u.t, std::exp(u.log_scale), frames[s.frame].color_camera, seen) ||
        !photos[s.frame].at(seen.pixel.x(), seen.pixel.y(), v, gradient))
      continue;
    value[i] = gains[s.frame] * v;
    slope[i] = gains[s.frame] * gradient.transpose() * seen.slope;
    sum[s.point] += value[i];
    mean_slope[s.point] += slope[i];
    count[s.point] += 1;
  }
  Eigen::Matrix<double, UNKNOWNS, UNKNOWNS> H = Eigen::Matrix<double, UNKNOWNS, UNKNOWNS>::Zero();
  Eigen::Matrix<double, UNKNOWNS, 1> g = Eigen::Matrix<double, UNKNOWNS, 1>::Zero();
  double squares = 0, n = 0;
  std::vector<double> gain_up(frames.size(), 0), gain_down(frames.size(), 0);
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Sight& s = sights[i];
    if (value[i] < 0 || count[s.point] < 3) continue;
    const double mean = sum[s.point] / count[s.point], r = value[i] - mean;
    const auto J = (slope[i] - mean_slope[s.point] / count[s.point]).eval();
    const double weight = std::abs(r) < HUBER ? 1 : HUBER / std::abs(r);
    H += weight * J.transpose() * J;
    g += weight * J.transpose() * r;
    squares += r * r;
    n += 1;
    gain_up[s.frame] += weight * mean * value[i];
    gain_down[s.frame] += weight * value[i] * value[i];
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
  const Eigen::Matrix<double, UNKNOWNS, 1> d = -H.ldlt().solve(g);
  const Vec3 w = d.head<3>();
  if (w.norm() > 0) u.R = Eigen::AngleAxisd(w.norm(), w.normalized()) * u.R;
  u.t += d.segment<3>(3);
  u.log_scale += d(6);
  double log_mean = 0, n_gains = 0;
  for (std::size_t f = 0; f < frames.size(); ++f)
    if (gain_down[f] > 0) {
      gains[f] *= gain_up[f] / gain_down[f];
      log_mean += std::log(gains[f]);
      n_gains += 1;
    }
  for (double& gain : gains) gain /= std::exp(log_mean / std::max(1.0, n_gains));
  return std::sqrt(squares / n);
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
    throw UsageError("the colour camera cannot be aligned: only " + std::to_string(out.n_points) +
                     " points of the surface are seen by three photos; take more photos, or give --align-colors no");
  std::vector<Gray> sharp(frames.size());
  for (std::size_t f = 0; f < frames.size(); ++f)
    if (!frames[f].color.empty()) sharp[f] = gray_of(color_of(frames[f]));
  Unknowns u;
  std::vector<double> gains(frames.size(), 1.0);
  bool is_first = true;
  for (const int rounds : {64, 16, 4, 1}) {  // blurred by 5.7, 2.8, 1.4 and 0.7 pixels
    std::vector<Gray> photos = sharp;
    for (Gray& photo : photos)
      if (photo.width > 0) blur(photo, rounds);
    if (is_first) {
      std::vector<Gray> last = sharp;
      for (Gray& photo : last)
        if (photo.width > 0) blur(photo, 1);
      out.disagreement_before = step(sights, frames, last, gains, chosen.size(), u, false);
      is_first = false;
    }
    for (int i = 0; i < 12; ++i) step(sights, frames, photos, gains, chosen.size(), u, true);
    out.disagreement_after = step(sights, frames, photos, gains, chosen.size(), u, false);
  }
  Pose to_color = Pose::Identity();
  to_color.linear() = u.R;
  to_color.translation() = u.t;
  out.pose = to_color.inverse();
  out.focal_scale = std::exp(u.log_scale);
  return out;
}

}  // namespace pvg
