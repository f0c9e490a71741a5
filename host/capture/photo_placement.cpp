// Where a photo was taken, by the colours that other photos gave the surface. The surface is drawn from the camera's
// pose T with the exposure of the photo P: a picture R and depths z. A motion T exp(w, v) of the camera moves what
// pixel u shows, X = z K^-1 u, to X - w x X - v, hence by du = pi'(X) (X x w - v) in the picture, and
//
//   r(u) = P(u) - R(u),   r after the motion: r + M'(u) du,   M = (P + R) / 2.
//
// Gauss-Newton with Geman's and McClure's loss, a new picture after each step. What is neither drawn nor measured does
// not count.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/statistics.hpp"
#include "host/capture/surface_views.hpp"
#include "host/pictures/gray_photo.hpp"

namespace pvg {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

constexpr int PLACEMENT_SAMPLES = 1;
constexpr int PLACEMENT_BLUR[] = {8, 2};        // rounds: by 2 pixels, then by one
constexpr int STEPS_PER_BLUR = 6;               // at most
constexpr double LEAST_MOTION = 1e-4;           // [m, rad]: smaller ones end them
constexpr int STRIDE = 2;                       // pixels; neighbours say the same
constexpr double PLACEMENT_LOSS_WIDTH = 2;      // standard deviations
constexpr double LEAST_DIFFERENCE = 0.01;       // steps of 8 bits, and what cameras do to them
constexpr double PIXELS_PER_DIFFERENCE = 3000;  // differences are alike over patches of so many
constexpr double GIVEN_SIGMA = 0.01;  // of the given pose [m], and of its rotation [rad], which is as much at 1 m
constexpr std::size_t FEWEST_COVERED = 1000;

GrayPhoto blurred_gray(const std::vector<float>& linear, int width, int height, int rounds) {
  GrayPhoto gray = gray_of(encode_srgb8(linear, width, height));
  blur(gray, rounds);
  return gray;
}

Eigen::Matrix3d turn_by(const Vec3& w) {
  return w.norm() > 0 ? Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

// (w, v) from one pose to the other, both along the axes of the camera
Vec6 camera_motion(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turned(from.linear().transpose() * to.linear());
  Vec6 m;
  m << turned.angle() * turned.axis(), from.linear().transpose() * (to.translation() - from.translation());
  return m;
}

struct PixelDifference {
  double r;    // photo less picture
  Vec6 slope;  // of r by (w, v)
};

std::vector<PixelDifference> differences(PhotoView view, const Camera& camera, int blur_rounds) {
  // what is not drawn shall not differ, so that the blur carries nothing of it to its neighbours
  for (std::size_t i = 0; i < view.is_drawn.size(); ++i)
    for (std::size_t k = 0; !view.is_drawn[i] && k < 3; ++k) view.rendered[3 * i + k] = view.photo[3 * i + k];
  const GrayPhoto photo = blurred_gray(view.photo, view.width, view.height, blur_rounds),
                  drawn = blurred_gray(view.rendered, view.width, view.height, blur_rounds);
  std::vector<PixelDifference> out;
  for (int y = 1; y + 1 < view.height; y += STRIDE)
    for (int x = 1; x + 1 < view.width; x += STRIDE) {
      const std::size_t i = std::size_t(y) * std::size_t(view.width) + std::size_t(x), row = std::size_t(view.width);
      if (!view.is_covered[i]) continue;
      const auto mean = [&](std::size_t at) { return 0.5 * double(photo.value[at] + drawn.value[at]); };
      const Eigen::RowVector2d gradient(0.5 * (mean(i + 1) - mean(i - 1)), 0.5 * (mean(i + row) - mean(i - row)));
      const double z = double(view.depth[i]), a = (x - camera.cx) / camera.fx, b = (y - camera.cy) / camera.fy;
      Eigen::Matrix<double, 2, 3> projection;
      projection << camera.fx / z, 0, -camera.fx * a / z, 0, camera.fy / z, -camera.fy * b / z;
      const Vec3 along = (gradient * projection).transpose(), X = z * Vec3(a, b, 1);
      PixelDifference d{double(photo.value[i]) - double(drawn.value[i]), {}};
      d.slope << along.cross(X), -along;
      out.push_back(d);
    }
  return out;
}

// the motion after which the picture is most like the photo; off: from the given pose
Vec6 placing_step(const std::vector<PixelDifference>& differences, const Vec6& off) {
  std::vector<double> sizes;
  for (const PixelDifference& d : differences) sizes.push_back(std::abs(d.r));
  const double sigma = std::max(LEAST_DIFFERENCE, SIGMA_OVER_MEDIAN * upper_median(sizes)),
               width = PLACEMENT_LOSS_WIDTH * sigma;
  constexpr double PRIOR = 1 / (GIVEN_SIGMA * GIVEN_SIGMA);
  Eigen::Matrix<double, 6, 6> H = PRIOR * Eigen::Matrix<double, 6, 6>::Identity();
  Vec6 g = PRIOR * off;
  for (const PixelDifference& d : differences) {
    const double share = 1 / (1 + d.r * d.r / (width * width)),
                 weight = STRIDE * STRIDE / PIXELS_PER_DIFFERENCE * share * share / (sigma * sigma);
    H += weight * d.slope * d.slope.transpose();
    g += weight * d.r * d.slope;
  }
  return -H.ldlt().solve(g);
}

}  // namespace

std::vector<Pose> place_photos(Device& device, std::span<const CaptureFrame> frames,
                               std::span<const CapturedSurface> surfaces) {
  RenderSettings settings;
  settings.samples = PLACEMENT_SAMPLES;
  settings.max_depth = 1;
  PhotoViews views(device, frames, surfaces, VisualMaterial::Kind::shadow_receiver, settings);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Camera& camera = frames[i].color_camera;
    Pose pose = camera.pose;
    for (const int blur_rounds : PLACEMENT_BLUR) {
      const std::optional<Lut> lut = own_lut(views.at(i, pose));
      for (int k = 0; lut && k < STEPS_PER_BLUR; ++k) {
        PhotoView view = views.at(i, pose);
        apply_lut(*lut, view);
        const std::vector<PixelDifference> all = differences(std::move(view), camera, blur_rounds);
        if (all.size() < FEWEST_COVERED) break;
        const Vec6 d = placing_step(all, camera_motion(camera.pose, pose));
        pose.translation() += pose.linear() * d.tail<3>();
        pose.linear() = pose.linear() * turn_by(d.head<3>());
        if (std::max(d.head<3>().norm(), d.tail<3>().norm()) < LEAST_MOTION) break;
      }
    }
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace pvg
